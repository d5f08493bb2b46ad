"""docs/performance.md: gaussmap compared with others, how its time grows, and the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gaussmap.docs.orders import markdown, wrapped

from ..quality.opening import beside_gmsh
from ..scale import LAST, STREAM, STREAMED, Series
from .catalogue import GMSH, RECIPE, SPLIPY_RECIPE, K
from .durations import Duration, durations
from .forms import ClosedForm
from .machine import machine
from .measure import JUDGED, Measured, Own
from .metrics import PLACES
from .opening import opening
from .peer import Peer
from .splines import NET

__all__ = ["OnSurface", "page"]

# The least speed of gaussmap at 10⁶ points, relative to others.
TARGETS: tuple[tuple[Peer, int], ...] = ((RECIPE, 20), (SPLIPY_RECIPE, 200), (GMSH, 1000))
STEEPEST = 1.05
QUALITY = Path(__file__).parents[2] / "docs" / "quality.md"


@dataclass(frozen=True)
class OnSurface:
    """All that was measured on one surface; `judged` is how many samples gaussmap gave, E and G."""

    form: ClosedForm
    peers: Sequence[Measured]
    own: Sequence[Own]
    judged: tuple[int, float, float]


TOP = """\
# Performance, measured

Written by `make bench-peers`: do not edit. The speed of a shared machine drifts; each ratio is the
median of ratios of two times that were taken right after each other.

"""

HEAD = """\
## Compared with other packages

Points **with normals**, as NumPy arrays, of three surfaces. Columns:

- **points/s**: for the number of points in the table, the median of several runs;
- **preparation**: seconds that points/s leaves out, for work that more points of the same surface
  do not repeat: the mesh of 205,000 triangles (trimesh, Open3D, PyMeshLab), the curvature on a grid
  of 512 × 512 (Splipy, |K|), the model, and the search for the setting that gives this count
  (Gmsh, Open CASCADE, PyMeshLab);
- **gaussmap, same count** and **10⁶**: the speed of `gm.sample(surface, normals=normals)` relative
  to that of the row, timed in turns, for the same count and for 10⁶ points, including the fit of
  64 × 64 cells to values of the surface;
- **E** and **G**, in degrees: the largest angles between the normals of {places:,} points of the
  surface, uniform by area, and the normals of {judged} samples. For E the sample is the nearest
  one in space; for G it is the nearest one in normal, among those with the same sign of K
  ([glossary](glossary.md)).

Splipy and geomdl use a cubic B-spline that interpolates the surface at {net} × {net} points; in
their rows gaussmap samples the same B-spline, by `gm.Surface.from_nurbs`. Gmsh and Open CASCADE
mesh this B-spline, too, except for the torus, which is one of their primitives. NumPy's grid
computes trigonometric functions along its two sides only. Meshes have exact normals at their
vertices, and their samples have interpolated ones. gaussmap is given the normals of a Fibonacci
lattice, which are not timed; with `count=…, density="gauss"` it computes them, and finds the number
that is needed. The recipes draw points at random; samples of gaussmap also have curvatures and
parameters, and so have those of NumPy's recipe. Each package uses its default number of threads;
that of gaussmap is one for each core.
"""

DENSITIES = """\
## The densities, and Gmsh

From [docs/quality.md](quality.md), which has more surfaces and tools.
"""

SCALE = """\
## Scale

`gm.sample(spline, normals=normals)` on the torus, for growing numbers of samples and of patches.
The slope is that of log(time) against log(patches + samples), by least squares, over all sizes and
over the {last} largest; 1 is linear, and the target is at most {steepest}. {streamed}
"""


def page(surfaces: Sequence[OnSurface], series: Sequence[Series], taken: Duration) -> str:
    """Return the page."""
    parts = [head(surfaces)]
    for measured in surfaces:
        parts += [f"### {measured.form.label}\n", table(measured)]
    first = [TOP + durations(taken), opening("\n".join(parts)), DENSITIES, densities()]
    parts.insert(0, "\n".join(first))
    parts.append(wrapped(SCALE.format(last=LAST, steepest=STEEPEST, streamed=streamed())))
    parts += [scale_table(x) for x in series]
    parts += [slopes(series), "## The machine\n", wrapped("\n".join(machine()))]
    parts += ["## Targets\n", targets(surfaces)]
    return "\n".join(parts)


def densities() -> str:
    """Return what docs/quality.md says of the densities."""
    return beside_gmsh(QUALITY.read_text(encoding="utf-8"))


def head(surfaces: Sequence[OnSurface]) -> str:
    """Return what the columns mean."""
    judged = [x.judged[0] for x in surfaces]
    judged += [x.judged for on in surfaces for x in on.peers if not x.missing]
    counts = f"about {JUDGED:,} ({min(judged):,} to {max(judged):,})"
    return wrapped(HEAD.format(judged=counts, places=PLACES, net=NET))


def table(measured: OnSurface) -> str:
    """Return the table of one surface: gaussmap first."""
    header = [
        "", "density follows", "points", "points/s", "preparation, s",
        "gaussmap, same count", "gaussmap, 10⁶", "E", "G",
    ]  # fmt: skip
    errors = [f"{x:.1f}" for x in measured.judged[1:]]
    rows = [
        [f"**`{x.call}`**", K, f"{x.points:,}", rate(x.rate), "", "", "", *errors]
        for x in measured.own
    ]
    return markdown(header, rows + [_row(x) for x in measured.peers])


def _row(x: Measured) -> list[str]:
    if x.missing:
        return [x.peer.title, x.peer.density, f"missing: {x.missing}", *["–"] * 6]
    return [
        x.peer.title,
        x.peer.density,
        f"{x.points:,}",
        rate(x.rate),
        f"{x.preparation:.2f}",
        times(x.times_same),
        times(x.times_million),
        *(f"{error:.1f}" for error in x.errors),
    ]


def targets(surfaces: Sequence[OnSurface]) -> str:
    """Return the table of targets, and of what is reached on each surface."""
    header = ["speed of gaussmap for 10⁶ points, relative to", "target"]
    header += [x.form.name for x in surfaces]
    rows = []
    for peer, target in TARGETS:
        found = [next(x for x in on.peers if x.peer is peer) for on in surfaces]
        rows.append([peer.title, f"≥ {target}", *(_reached(x, target) for x in found)])
    return markdown(header, rows)


def _reached(x: Measured, target: int) -> str:
    if x.missing:
        return "missing"
    return f"{times(x.times_million)}, {'met' if x.times_million >= target else 'not met'}"


def streamed() -> str:
    """Return how samples that do not fit into memory were counted."""
    if STREAM is None:
        return ""
    return f"More than {STREAMED:,} samples come from `gm.sample_stream`, and are only counted."


def scale_table(series: Series) -> str:
    """Return the table of one series."""
    header = ["patches", "samples", "seconds", "ns for a patch or sample"]
    rows = [
        [f"{patches:,}", f"{samples:,}", f"{t:.2g}", f"{1e9 * t / (patches + samples):.0f}"]
        for patches, samples, t in series.rows
    ]
    note = f"\n{series.missing}.\n" if series.missing else ""
    return markdown(header, rows) + note


def slopes(series: Sequence[Series]) -> str:
    """Return the table of the slopes."""
    header = ["growing number of", "slope", f"slope, {LAST} largest", f"≤ {STEEPEST}"]
    rows = []
    for x in series:
        found = x.slope(), x.slope(LAST)
        met = "yes" if max(found) <= STEEPEST else "no"
        rows.append([x.title, *(f"{slope:.2f}" for slope in found), met])
    return markdown(header, rows)


def rate(value: float) -> str:
    """Return points a second with two digits."""
    return f"{value:.1e}".replace("e+0", "e")


def times(value: float) -> str:
    """Return a ratio with two digits or as a whole number."""
    return f"{value:,.0f} ×" if value >= 10 else f"{value:.2g} ×"
