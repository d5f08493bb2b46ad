"""docs/quality.md: how well samples represent surfaces, by task and compared with others."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gaussmap.docs.orders import listed, markdown, number, wrapped

from ..peers.machine import machine
from ..peers.mesh_metrics import Quality
from ..peers.metrics import PLACES
from ..peers.page import rate, times
from . import tasks
from .criteria import CRITERIA, Verdict, verdicts, worst
from .measure import COUNTS, LAST, Found, OnSurface
from .meshers import MESHERS
from .opening import opening
from .small import Few, section
from .ways import ROUNDS, WAYS

__all__ = ["page"]

NAMED = 4  # cases that are named; more are counted
BUSY = 0.5  # of the cores

HEAD = """\
# How well samples represent a surface, measured

Written by `make quality`: do not edit. Points **with normals**, and meshes through them, of
{surfaces} surfaces, by the densities of gaussmap and by others.
"""

TASKS = """\
## Which density for which task

The numbers below the densities are errors at {last:,} points relative to **balanced**, the
geometric mean over all surfaces of this page: smaller is better. The density to take is the best
one over all that counts for the task, and the default where it is about as good. The last column
says who has a smaller error than it, on which surfaces, and their error relative to it where that
is smallest. On half of these surfaces parameters run along lines of curvature, which **aligned** is
for: the tables of the others say what it does there.
"""

COLUMNS = """\
- **registration**: point-to-plane ICP measures distances to the tangent plane of the nearest
  sample.
- **meshing**: worst and mean angle between the normals of the surface and of the mesh, and the
  larger one of the distances from the surface to the mesh and back. Meshes have about {last:,}
  vertices and prefer normals, but for the first row of each table.
- **inspection**: nothing of the surface may be far from a sample, in space (gap) or in normal (G).
- **look-up, learning**: what is stored at the nearest sample is to be right on average (mean E),
  and near (gap).
- **no normal may be far off**: E and the other measures are explained below.

**balanced**, the default, makes distances the same in all directions; **aligned** puts samples in
rows along parameter lines, which is best where these are lines of curvature
([why](mathematics/densities.md)). **gauss** has the samples at given normals only, and nothing in
planes and cylinders; **uniform** ignores curvature.

## What is measured

- **E** and **G**, in degrees: the largest angles between the normals of {places:,} points of the
  surface, uniform by area, and the normals of samples. For E the sample is the nearest one in
  space; for G it is the nearest one in normal, among those with the same sign of K. A plane has one
  normal, so that neither E nor G shows whether it is sampled ([glossary](glossary.md)). **mean E**
  is the mean angle to the nearest sample in space;
- **gap**: the largest distance from these points to the nearest sample, and **plane**: to its
  tangent plane, in the unit of the surface;
- **points/s**: the median of {clouds} runs (one run of what takes long);
- **balanced**: the speed of `gm.sample(surface, count=…)` for the same count, relative to that of
  the row: the median of ratios of two times that were taken right after each other, as the speed of
  a shared machine drifts.

The bold rows are `gm.sample(surface, count=…, density=…)`, each call with the fit of a spline to
the surface. *The paper's method, exact* uses the same normals as **gauss**, and the inverse Gauss
map in closed form instead of a spline; the row below it uses the normals of a refined icosahedron,
as in the paper.
The times of others leave out meshes, models and the search for the setting that gives a count.
Poisson disks are random: errors are the medians of {clouds} samplings. The
B-splines, meshes and normals of other packages are those of [performance.md](performance.md); in
Gmsh and Open CASCADE the boss is a solid of revolution with five faces, and the torus is the same
whatever its parameters are. Constants of gaussmap were chosen on the first three surfaces and on
the boss; nothing was chosen on `bent_pipe` and `hills`.
"""

TARGETS = """\
## Targets

Values and ratios at {counts} points, unless a count is given; *mesh* is that through the density
named, with `prefer="normals"`. With the same normals, G of **gauss** can differ from the exact one
only by points that appear or vanish, or change the sign of K, because of the spline.
"""


def page(
    surfaces: Sequence[OnSurface], load: float | None = None, small: Sequence[Few] = ()
) -> str:
    """Return the page; `load` is the load of the machine before the measurement."""
    counts = " and ".join(f"{x:,}" for x in COUNTS)
    columns = COLUMNS.format(places=PLACES, last=LAST, clouds=ROUNDS)
    parts = [
        wrapped(TASKS.format(last=LAST)),
        tasks.table(surfaces),
        wrapped(columns),
    ]
    for on in surfaces:
        title = f"## {on.form.label}\n\nNamed `{on.form.name}` in other tables.\n"
        parts += [title, folded("Points and meshes", points_table(on), mesh_table(on))]
    parts += [section(small)] if small else []
    parts += ["## The machine\n", wrapped("\n".join([*machine(), *busy(load)]))]
    parts += [wrapped(TARGETS.format(counts=counts)), targets(surfaces)]
    text = "\n".join(parts)
    return "\n".join([wrapped(HEAD.format(surfaces=len(surfaces))), opening(text), text])


def folded(title: str, *tables: str) -> str:
    """Return tables that are seen after a click on a title; browsers search in them, too."""
    inner = "\n".join(tables)
    return f"<details>\n<summary>{title}</summary>\n\n{inner}\n</details>\n"


def busy(load: float | None) -> list[str]:
    """Return an item of a list that warns of times that were taken beside other work."""
    if load is None or load < BUSY:
        return []
    return [
        f"- Others were computing when this was measured (a load of {load:.1f}): times are only "
        "indicative."
    ]


def points_table(on: OnSurface) -> str:
    """Return the table of the points on one surface."""
    groups = [f"{x}, {COUNTS[0]:,}" for x in ("E", "G")]
    header = ["", *groups, "points", "E", "mean E", "G", "gap", "plane", "points/s", "balanced"]
    rows = []
    for way in WAYS:
        if way in on.missing:
            rows.append([way.title, f"missing: {on.missing[way]}", *["–"] * (len(header) - 2)])
            continue
        first = on.found[way, COUNTS[0]].errors
        rows.append([way.title, f"{first.E:.2f}", f"{first.G:.2f}", *row(on.found[way, LAST])])
    return markdown(header, rows)


def row(x: Found) -> list[str]:
    """Return the cells of one way."""
    e = x.errors
    angles = (f"{angle:.2f}" for angle in (e.E, e.mean, e.G))
    speed = rate(x.rate), "–" if math.isnan(x.times) else times(x.times)
    return [f"{x.points:,}", *angles, number(e.gap), number(e.plane), *speed]


def mesh_table(on: OnSurface) -> str:
    """Return the table of the meshes of one surface."""
    header = ["mesh", "vertices", "worst angle", "mean angle", "Hausdorff distance", "shape"]
    rows = []
    for mesher in MESHERS:
        if mesher in on.missing:
            rows.append([mesher.title, f"missing: {on.missing[mesher]}", *["–"] * 4])
        else:
            rows.append([mesher.title, *mesh_row(on.meshes[mesher])])
    return markdown(header, rows)


def mesh_row(x: Quality) -> list[str]:
    """Return the cells of one mesh."""
    angles = f"{x.worst:.2f}", f"{x.mean:.2f}"
    return [f"{x.vertices:,}", *angles, number(x.hausdorff), f"{x.small:.1f}"]


def targets(surfaces: Sequence[OnSurface]) -> str:
    """Return the table of targets."""
    header = ["", "on", "target", "worst", "where", "met", "not met"]
    rows = []
    for criterion in CRITERIA:
        found = verdicts(criterion, tuple(surfaces))
        known = [x for x in found if x.met is not None]
        failed = [x for x in known if not x.met]
        farthest = worst(found)
        rows.append(
            [
                criterion.title,
                listed(criterion.surfaces) if criterion.surfaces else "all",
                criterion.target,
                "missing" if farthest is None else value(farthest),
                "–" if farthest is None else place(farthest),
                verdict(len(known) - len(failed), len(known)),
                unmet(failed),
            ]
        )
    return markdown(header, rows)


def verdict(met: int, known: int) -> str:
    """Say whether a target is met, and how often."""
    if not known:
        return "not known"
    return f"{'met' if met == known else '**not met**'}, {met} of {known}"


def unmet(failed: Sequence[Verdict]) -> str:
    """Name the cases in which a target is missed."""
    if not failed:
        return "–"
    named = [f"{place(x)}: {value(x)}" for x in failed[:NAMED]]
    rest = len(failed) - len(named)
    return "; ".join([*named, *([f"{rest} more"] if rest else [])])


def place(found: Verdict) -> str:
    """Return where a value was found."""
    return f"{found.surface}, {found.count:,}"


def value(found: Verdict) -> str:
    """Return a value."""
    assert found.value is not None
    return times(found.value) if found.criterion.at_least else f"{found.value:.3f}"
