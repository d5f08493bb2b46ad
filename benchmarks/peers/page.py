"""docs/performance.md: gaussmap beside others, how its time grows, and the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gaussmap.docs.orders import markdown, wrapped

from ..scale import LAST, STREAM, STREAMED, Series
from .catalogue import GMSH, RECIPE, SPLIPY_RECIPE, K
from .forms import ClosedForm
from .machine import machine
from .measure import JUDGED, Measured, Own
from .metrics import PLACES
from .peer import Peer
from .splines import NET

__all__ = ["OnSurface", "page"]

# gaussmap at 10⁶ points shall be at least so many times as fast.
TARGETS: tuple[tuple[Peer, int], ...] = ((RECIPE, 20), (SPLIPY_RECIPE, 200), (GMSH, 1000))
STEEPEST = 1.05


@dataclass(frozen=True)
class OnSurface:
    """All that was measured on one surface; `judged` is how many samples gaussmap gave, E and G."""

    form: ClosedForm
    peers: Sequence[Measured]
    own: Sequence[Own]
    judged: tuple[int, float, float]


HEAD = """\
# Performance, measured

Written by `make bench-peers`: do not edit. The speed of a machine that others use drifts; ratios
are medians of ratios of two times that were taken right after each other.

## Beside others

Points **with normals**, as NumPy arrays, of three surfaces. Columns:

- **points/s**: of so many points as the table says, the median of several runs;
- **preparation**: seconds that are not in it, for what need not be repeated for more points of the
  same surface: the mesh of 205,000 triangles (trimesh, Open3D, PyMeshLab), the curvature on a grid
  of 512 × 512 (Splipy, |K|), the model, and the search for the setting that gives this count
  (Gmsh, Open CASCADE, PyMeshLab);
- **gaussmap, same count** and **10⁶**: how many times as fast is
  `gm.sample(surface, normals=normals)`, timed in turns, with the fit of 64 × 64 cells from the
  surface's values, for the same count and for 10⁶ points;
- **E** and **G**, in degrees: how badly {judged} points stand for the surface at the worst of
  {places:,} places that are uniform by area. E is the angle between the normal of a place and that
  of the sample nearest in space; G the angle to the sample nearest in normal, among those with the
  same sign of K.

Splipy and geomdl have a cubic B-spline that interpolates the surface at {net} × {net} points; in
their rows gaussmap samples the same B-spline, by Splipy's evaluation. Gmsh and Open CASCADE mesh
this B-spline, too, but for the torus, which is one of their own shapes. NumPy's grid computes
trigonometric functions along its two sides only. Meshes have exact normals at their vertices, and
samples those, interpolated. gaussmap is given normals of a Fibonacci lattice that were made before;
with `count=…, density="gauss"` it makes them, and finds out how many are needed. The recipes draw
points at random; gaussmap's also have curvatures and parameters, and so has NumPy's recipe. Each
package uses the threads that it uses by default; for gaussmap that is one for each core.
"""

SCALE = """\
## Scale

`gm.sample(spline, normals=normals)` on the torus, for growing numbers of samples and of patches.
The slope is that of log(time) against log(patches + samples), by least squares, over all sizes and
over the {last} largest: at most {steepest} is wanted, 1 is linear. {streamed}
"""


def page(surfaces: Sequence[OnSurface], series: Sequence[Series]) -> str:
    """Return the page."""
    parts = [head(surfaces)]
    for measured in surfaces:
        parts += [f"### {measured.form.label}\n", table(measured)]
    parts += ["### Targets\n", targets(surfaces)]
    parts.append(wrapped(SCALE.format(last=LAST, steepest=STEEPEST, streamed=streamed())))
    parts += [scale_table(x) for x in series]
    parts += [slopes(series), "## The machine\n", wrapped("\n".join(machine()))]
    return "\n".join(parts)


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
    """Return the table of what is wanted, and what is reached on each surface."""
    header = ["10⁶ points of gaussmap, as many times as fast as", "wanted"]
    header += [x.form.name for x in surfaces]
    rows = []
    for peer, wanted in TARGETS:
        found = [next(x for x in on.peers if x.peer is peer) for on in surfaces]
        rows.append([peer.title, f"≥ {wanted}", *(_reached(x, wanted) for x in found)])
    return markdown(header, rows)


def _reached(x: Measured, wanted: int) -> str:
    if x.missing:
        return "missing"
    return f"{times(x.times_million)}, {'met' if x.times_million >= wanted else 'not met'}"


def streamed() -> str:
    """Say how more samples than can be held were counted."""
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
