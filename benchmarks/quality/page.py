"""docs/quality.md: how well samples stand for surfaces, beside others, and what was asked."""

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
# How well samples stand for a surface, measured

Written by `make quality`: do not edit. Points **with normals** of five surfaces; the constants of
gaussmap were chosen on the first three, and nothing was tuned for the other two. Columns:

- **E** and **G**, in degrees, at the worst of {places:,} places that are uniform by area. E is the
  angle between the normal of a place and that of the sample nearest in space; G the angle to the
  sample nearest in normal, among those with the same sign of K. Flat parts have one normal, so
  that neither sees whether they are sampled;
- **points/s**: the median of several runs (relaxed: one); of {large:,} points one run, after the
  others and only where that takes less than about {feasible:g} s;
- **balanced**: how many times as fast `gm.sample(surface, count=…)` is for the same count: the
  median of ratios of two times that were taken right after each other, as the speed of a machine
  that others use drifts.

The bold rows are `gm.sample(surface, count=…, density=…)`, each call with the fit of a spline to
the surface. *The paper's method, exact* takes the same normals as **gauss**, and the inverse of the
Gauss map in closed form instead of a spline; below it are the normals of a refined icosahedron, as
in the paper.
Meshes, models and the search for the setting that gives a count are not in the time of others.
Poisson disks are random: E and G are the medians of {clouds} clouds. The B-splines, meshes and
normals of other packages are those of [performance.md](performance.md); the boss is made by Gmsh
and Open CASCADE as a solid of revolution, with five faces.
"""

ASKED = """\
## What was asked

Ratios at {counts} points; *relaxed* is `relax={steps}` on every surface. The last columns are the
worst ratio, and how often it is met. The goal was asked for as one to come near to. With the same
normals, G of **gauss** can differ from the exact one only by points that appear or vanish, or
change the sign of K, because of the spline.
"""


def page(surfaces: Sequence[OnSurface], ways: Sequence[Peer]) -> str:
    """Return the page."""
    head = HEAD.format(places=PLACES, large=LARGE, feasible=FEASIBLE, clouds=CLOUDS)
    counts = " and ".join(f"{x:,}" for x in COUNTS)
    parts = [wrapped(head), wrapped(ASKED.format(counts=counts, steps=JUDGED_STEPS))]
    parts.append(acceptance(surfaces))
    for on in surfaces:
        parts += [f"## {on.form.label}\n", table(on, ways)]
    parts += ["## The machine\n", wrapped("\n".join(machine()))]
    return "\n".join(parts)


def acceptance(surfaces: Sequence[OnSurface]) -> str:
    """Return the table of what was asked."""
    header = ["", "asked", *(x.form.name for x in surfaces), "worst", "met"]
    rows = []
    for criterion in CRITERIA:
        found = [verdicts(criterion, on, COUNTS) for on in surfaces]
        cells = [", ".join(verdict(x) for x in row) for row in found]
        every = [x for row in found for x in row]
        last = [ratio(worst(every)), share(every)]
        rows.append([criterion.title, criterion.asked, *cells, *last])
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
