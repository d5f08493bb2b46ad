"""docs/performance.md: gaussmap compared with others, how its time grows, and the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gaussmap.docs.markdown import markdown, wrapped

from ..scale import LAST, STREAMED, Series
from .catalogue import K
from .durations import Duration, durations
from .forms import ClosedForm
from .machine import machine
from .measure import JUDGED, Measured, Own
from .metrics import PLACES
from .opening import opening
from .splines import NET


@dataclass(frozen=True)
class OnSurface:
    """The measurements on one surface; `judged` is E and G of gaussmap."""

    form: ClosedForm
    peers: Sequence[Measured]
    own: Sequence[Own]
    judged: tuple[float, float]


TOP = """\
# Performance, measured

Written by `make bench-peers`: do not edit. The speed of a shared machine drifts; each ratio is the
median of ratios of two times that were taken right after each other.

"""

HEAD = """\
## Compared with other packages

Points **with normals**, as NumPy arrays, of three surfaces. Columns:

- **points/s**: for the number of points in the table, the median of several runs;
- **preparation**: seconds that points/s does not include, of work that is done once for a surface:
  the mesh of 205,000 triangles (trimesh, Open3D, PyMeshLab), the curvature on a grid of 512 × 512
  (Splipy, |K|), the model, and the search for the setting that gives this count (Gmsh, Open
  CASCADE, PyMeshLab);
- **gaussmap, same count** and **10⁶**: the speed of `gm.sample(surface, normals=normals)` relative
  to the speed in the row, both timed in turns, for the same count and for 10⁶ points, including the
  fit of 64 × 64 cells to values of the surface;
- **E** and **G**, in degrees: the largest angles between the normals of {places:,} points of the
  surface, uniform by area, and the normals of about {judged:,} samples. For E the sample is the
  nearest one in space; for G it is the nearest one in normal, among those with the same sign of K
  ([glossary](glossary.md)).

Splipy and geomdl use a cubic B-spline that interpolates the surface at {net} × {net} points; in
their rows gaussmap samples the same B-spline, by `gm.Surface.from_nurbs`. Gmsh and Open CASCADE
mesh this B-spline, too, except for the torus, which is one of their primitives. NumPy's grid
computes trigonometric functions along its two sides only. Meshes have exact normals at their
vertices; samples on meshes have interpolated normals. gaussmap is given the normals of a Fibonacci
lattice, whose computation is not timed; with `count=…, density="gauss"` it computes these normals,
and finds the number of normals that is needed. The packages whose names contain "recipe" draw
points at random. Samples of gaussmap and of NumPy's recipe also have curvatures and parameters.
Each package uses its default number of threads; the default of gaussmap is one for each core.
"""

SCALE = """\
## Scale

`gm.sample(spline, normals=normals)` on the torus, for growing numbers of samples and of patches.
The slope is that of log(time) against log(patches + samples), by least squares, over all sizes and
over the {last} largest; 1 is linear. More than {streamed:,} samples come from
`gm.sample_stream`, and are only counted.
"""


def page(surfaces: Sequence[OnSurface], series: Sequence[Series], taken: Duration) -> str:
    """Return the page."""
    parts = [wrapped(HEAD.format(judged=JUDGED, places=PLACES, net=NET))]
    for measured in surfaces:
        parts += [f"### {measured.form.label}\n", table(measured)]
    won = opening("\n".join(parts))
    parts.insert(0, f"{TOP}{durations(taken)}\n{won}")
    parts.append(wrapped(SCALE.format(last=LAST, streamed=STREAMED)))
    parts += [scale_table(x) for x in series]
    parts += [slopes(series), "## The machine\n", wrapped("\n".join(machine()))]
    return "\n".join(parts)


def table(measured: OnSurface) -> str:
    """Return the table of one surface: gaussmap first."""
    header = [
        "", "density follows", "points", "points/s", "preparation, s",
        "gaussmap, same count", "gaussmap, 10⁶", "E", "G",
    ]  # fmt: skip
    errors = [f"{x:.1f}" for x in measured.judged]
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


def scale_table(series: Series) -> str:
    """Return the table of one series."""
    header = ["patches", "samples", "seconds", "ns for a patch or sample"]
    rows = [
        [f"{patches:,}", f"{samples:,}", f"{t:.2g}", f"{1e9 * t / (patches + samples):.0f}"]
        for patches, samples, t in series.rows
    ]
    return markdown(header, rows)


def slopes(series: Sequence[Series]) -> str:
    """Return the table of the slopes."""
    header = ["growing number of", "slope", f"slope, {LAST} largest"]
    rows = [[x.title, f"{x.slope():.2f}", f"{x.slope(LAST):.2f}"] for x in series]
    return markdown(header, rows)


def rate(value: float) -> str:
    """Return points a second with two digits."""
    return f"{value:.1e}".replace("e+0", "e")


def times(value: float) -> str:
    """Return a ratio with two digits or as a whole number."""
    return f"{value:,.0f} ×" if value >= 10 else f"{value:.2g} ×"
