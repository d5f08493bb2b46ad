"""docs/quality.md: the errors of samples and meshes of surfaces, compared with other tools."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gaussmap.docs.markdown import markdown, number, wrapped

from ..peers.machine import machine
from ..peers.mesh_metrics import Quality
from ..peers.metrics import PLACES
from ..peers.page import rate, times
from .measure import COUNTS, LAST, Found, OnSurface
from .meshers import MESHERS
from .opening import opening
from .ways import ROUNDS, WAYS

BUSY = 0.5  # of the cores

HEAD = """\
# How well samples represent a surface, measured

Written by `make quality`: do not edit. Points **with normals**, and meshes through them, of
{surfaces} surfaces, by the densities of gaussmap and by other tools.
"""

COLUMNS = """\
## What is measured

**balanced**, the default, makes distances the same in all directions; **aligned** puts samples in
rows along parameter lines, which is best where these are lines of curvature
([why](mathematics/densities.md)). **gauss** has samples at given normals only, and none in planes
and cylinders; **uniform** ignores curvature.

- **E** and **G**, in degrees: the largest angles between the normals of {places:,} points of the
  surface, uniform by area, and the normals of samples. For E the sample is the nearest one in
  space; for G it is the nearest one in normal, among those with the same sign of K. A plane has one
  normal, so that neither E nor G shows whether it is sampled ([glossary](glossary.md)). **mean E**
  is the mean angle to the nearest sample in space;
- **gap**: the largest distance from these points to the nearest sample, and **plane**: the largest
  distance from these points to the tangent plane of the nearest sample, both in the unit of the
  surface. Point-to-plane registration measures distances from tangent planes;
- **worst** and **mean angle**: between the normals of the surface and of a mesh of about {last:,}
  vertices, and **Hausdorff distance**: the larger one of the distances from the surface to the mesh
  and back. 95 % of the triangles have angles of at least **shape** degrees;
- **points/s**: the median of {clouds} runs (a single run if it takes long);
- **balanced**: the speed of `gm.sample(surface, count=…)` for the same count, relative to the speed
  in the row: the median of ratios of two times that were taken right after each other, as the speed
  of a shared machine drifts.

The bold rows are `gm.sample(surface, count=…, density=…)`, each call with the fit of a spline to
the surface. *The paper's method, exact* uses the same normals as **gauss**, and the inverse Gauss
map in closed form instead of a spline; the row below it uses the normals of a refined icosahedron,
as in the paper. The times of other tools do not include making meshes and models, or the search for
the setting that gives a count. Poisson disks are random: errors are the medians of {clouds}
samplings. The B-splines, meshes and normals of other packages are those of
[performance.md](performance.md); in Gmsh and Open CASCADE the boss is a solid of revolution with
five faces, and the torus is the same whatever its parameters are. Constants of gaussmap were chosen
on the first three surfaces and on the boss; nothing was chosen on `bent_pipe` and `hills`.
"""


def page(surfaces: Sequence[OnSurface], load: float | None = None) -> str:
    """Return the page; `load` is the load of the machine before the measurement."""
    columns = COLUMNS.format(places=PLACES, last=LAST, clouds=ROUNDS)
    parts = [wrapped(columns)]
    for on in surfaces:
        title = f"## {on.form.label}\n\nIts name in the benchmarks is `{on.form.name}`.\n"
        parts += [title, folded("Points and meshes", points_table(on), mesh_table(on))]
    parts += ["## The machine\n", wrapped("\n".join([*machine(), *busy(load)]))]
    text = "\n".join(parts)
    return "\n".join([wrapped(HEAD.format(surfaces=len(surfaces))), opening(text), text])


def folded(title: str, *tables: str) -> str:
    """Return tables that open after a click on a title; browsers search in them, too."""
    inner = "\n".join(tables)
    return f"<details>\n<summary>{title}</summary>\n\n{inner}\n</details>\n"


def busy(load: float | None) -> list[str]:
    """Return list items: a warning if other processes were running during the measurement."""
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
