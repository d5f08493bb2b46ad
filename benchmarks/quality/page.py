"""docs/quality.md: how well samples represent surfaces, compared with others, and the targets."""

from __future__ import annotations

from collections.abc import Sequence

from gaussmap.docs.orders import markdown, wrapped

from ..peers.machine import machine
from ..peers.metrics import PLACES
from ..peers.page import rate, times
from ..peers.peer import Peer
from .criteria import CRITERIA, JUDGED_STEPS, Verdict, share, verdicts, worst
from .measure import CLOUDS, COUNTS, FEASIBLE, LARGE, OnSurface

__all__ = ["page"]

HEAD = """\
# How well samples represent a surface, measured

Written by `make quality`: do not edit. Points **with normals** of five surfaces; the constants of
gaussmap were chosen on the first three, and were not changed for the other two. Columns:

- **E** and **G**, in degrees: the largest angles between the normals of {places:,} points of the
  surface, uniform by area, and the normals of samples. For E the sample is the nearest one in
  space; for G it is the nearest one in normal, among those with the same sign of K. A plane has one
  normal, so that neither E nor G shows whether it is sampled
  ([glossary](glossary.md));
- **points/s**: the median of several runs (relaxed: one run); for {large:,} points one run, after
  the others, and only if it takes less than about {feasible:g} s;
- **balanced**: the speed of `gm.sample(surface, count=…)` for the same count, relative to that of
  the row: the median of ratios of two times that were taken right after each other, as the speed of
  a shared machine drifts.

The bold rows are `gm.sample(surface, count=…, density=…)`, each call with the fit of a spline to
the surface. *The paper's method, exact* uses the same normals as **gauss**, and the inverse Gauss
map in closed form instead of a spline; the row below it uses the normals of a refined icosahedron,
as in the paper.
The times of others leave out meshes, models and the search for the setting that gives a count.
Poisson disks are random: E and G are the medians of {clouds} samplings. The B-splines, meshes and
normals of other packages are those of [performance.md](performance.md); in Gmsh and Open CASCADE
the boss is a solid of revolution with five faces.
"""

TARGETS = """\
## Targets

Ratios at {counts} points; *relaxed* is `relax={steps}` on every surface. The last columns are the
worst ratio, and in how many cases the target is met. The goal is to be approached, not met. With
the same normals, G of **gauss** can differ from the exact one only by points that appear or vanish,
or change the sign of K, because of the spline.
"""


def page(surfaces: Sequence[OnSurface], ways: Sequence[Peer]) -> str:
    """Return the page."""
    head = HEAD.format(places=PLACES, large=LARGE, feasible=FEASIBLE, clouds=CLOUDS)
    counts = " and ".join(f"{x:,}" for x in COUNTS)
    parts = [wrapped(head), wrapped(TARGETS.format(counts=counts, steps=JUDGED_STEPS))]
    parts.append(acceptance(surfaces))
    for on in surfaces:
        parts += [f"## {on.form.label}\n", table(on, ways)]
    parts += ["## The machine\n", wrapped("\n".join(machine()))]
    return "\n".join(parts)


def acceptance(surfaces: Sequence[OnSurface]) -> str:
    """Return the table of targets."""
    header = ["", "target", *(x.form.name for x in surfaces), "worst", "met"]
    rows = []
    for criterion in CRITERIA:
        found = [verdicts(criterion, on, COUNTS) for on in surfaces]
        cells = [", ".join(verdict(x) for x in row) for row in found]
        every = [x for row in found for x in row]
        last = [ratio(worst(every)), share(every)]
        rows.append([criterion.title, criterion.target, *cells, *last])
    return markdown(header, rows)


def verdict(found: Verdict) -> str:
    """Return a ratio, and whether it is met."""
    if found.value is None:
        return "missing"
    return f"{ratio(found)} {'met' if found.met else '**not met**'}"


def ratio(found: Verdict) -> str:
    """Return a ratio."""
    if found.value is None:
        return "missing"
    return times(found.value) if found.criterion.at_least else f"{found.value:.3f}"


def table(on: OnSurface, ways: Sequence[Peer]) -> str:
    """Return the table of one surface."""
    groups = ["points", "E", "G", "points/s", "balanced"]
    header = ["", *groups * len(COUNTS), f"points/s, {LARGE:,}", "balanced"]
    rows = []
    for way in ways:
        if way in on.missing:
            rows.append([way.title, f"missing: {on.missing[way]}", *["–"] * (len(header) - 2)])
            continue
        row = [way.title]
        for count in COUNTS:
            x = on.found[way, count]
            row += [f"{x.points:,}", f"{x.E:.2f}", f"{x.G:.2f}", rate(x.rate), times(x.times)]
        large = on.large.get(way)
        row += ["–", "–"] if large is None else [rate(large[0]), times(large[1])]
        rows.append(row)
    return markdown(header, rows)
