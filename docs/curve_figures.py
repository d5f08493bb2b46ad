"""Figs. 4 and 5: a curve sampled by uniform normals, and the polygons through its points."""

from __future__ import annotations

import warnings

import gaussmap as gm
import numpy as np
import shapely
import sympy as sp
from gaussmap.docs.drawing import HALO, Floats, panels
from gaussmap.docs.markdown import listed
from gaussmap.symbolic.display import latex_of
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, INK, NO_SAMPLE
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

t = sp.Symbol("t", real=True)
# A circle with one narrow bump and two concave arcs next to it, in polar coordinates.
RADIUS = 1 + sp.sin(2 * t) / 6 + sp.Rational(4, 5) * sp.exp(24 * (sp.cos(t) - 1))
POSITION = (RADIUS * sp.cos(t), RADIUS * sp.sin(t))
DROP = gm.curves.Curve.from_sympy(POSITION, t, (sp.S.Zero, 2 * sp.pi), True, name="drop")
ROWS = sp.lambdify(t, [sp.diff(x, t, k) for k in range(3) for x in POSITION], "numpy", cse=True)
PIECES = 4096  # so that the error of the spline is far below that of the polygons
DENSE = 40_000  # parameters at which curve and polygon are compared
NORMALS = 24
EVERY = 3  # every third point is numbered
VERTICES = 24
SMOOTH = 2001  # points of a drawn curve
FINE = 100_001  # points at which the length of a curve is measured


def derivatives(places: Floats) -> Floats:
    """Return x, x_t and x_tt at parameters (k,), as an array (3, k, 2)."""
    values = [np.broadcast_to(x, places.shape) for x in ROWS(places)]
    return np.moveaxis(np.array(values).reshape(3, 2, -1), 1, 2)


def by_parameter(count: int) -> Floats:
    """Return equally spaced parameters, both ends included."""
    return np.linspace(*DROP.domain, count)


def by_normals(count: int) -> Floats:
    """Return the parameters of about `count` points with uniform normals, then the first again."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        found = gm.curves.sample(DROP, count=count, pieces=PIECES).parameters
    return np.append(found, found[0] + np.ptp(DROP.domain))


def figure_4() -> tuple[Figure, str]:
    """Draw uniform normals on the circle, and the points of a curve that have them."""
    figure, ((left, right),) = panels(
        6.6, 2.9, 1, 2, left=0.0, right=1.0, bottom=0.0, top=0.9, wspace=0.0, width_ratios=(1, 1.5)
    )
    normals = gm.directions.circle(NORMALS)
    samples = gm.curves.sample(DROP, normals=normals, pieces=PIECES)
    left.set_title(f"{NORMALS} uniform normals", pad=4)
    draw_normals(left, normals, normals[samples.normal_index[samples.curvature < 0.0]])
    left.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.26), anchor="N")
    right.set_title(f"The {len(samples)} points of the curve that have them", pad=4)
    draw_samples(right, samples)
    right.set(xlim=(-1.55, 2.15), ylim=(-1.45, 1.42), anchor="N")
    return figure, caption_4(samples)


def draw_normals(axes: Axes, normals: Floats, negative: Floats) -> None:
    """Draw unit normals, with an orange mark on the `negative` ones, of points with κ < 0."""
    segments(axes, np.zeros_like(normals), normals, colors=NO_SAMPLE, linewidths=0.6)
    axes.scatter(0.0, 0.0, s=8, color=INK, linewidths=0, zorder=3)
    draw_curve(axes, gm.directions.circle(SMOOTH), closed=True)
    dots(axes, normals, normals[::EVERY], ELLIPTIC)
    axes.scatter(*negative.T, s=4, color=HYPERBOLIC, linewidths=0, zorder=6)
    labels(axes, normals[::EVERY], normals[::EVERY], np.arange(0, NORMALS, EVERY))


def draw_samples(axes: Axes, samples: gm.curves.CurveSamples) -> None:
    """Draw the curve, and samples with their normals, blue where κ > 0 and orange where κ < 0."""
    draw_curve(axes, derivatives(by_parameter(SMOOTH))[0])
    tips = samples.points + 0.17 * samples.normals
    numbered = samples.normal_index % EVERY == 0
    for chosen, colour in (
        (samples.curvature > 0.0, ELLIPTIC),
        (samples.curvature < 0.0, HYPERBOLIC),
    ):
        segments(axes, samples.points[chosen], tips[chosen], colors=colour, linewidths=0.8)
        dots(axes, samples.points[chosen], samples.points[chosen & numbered], colour)
    labels(axes, tips[numbered], samples.normals[numbered], samples.normal_index[numbered])


def caption_4(samples: gm.curves.CurveSamples) -> str:
    """Return the caption of Fig. 4, with the numbers of points of a normal."""
    points = np.bincount(samples.normal_index, minlength=NORMALS)
    counts = listed(f"{(points == k).sum()} have {k}" for k in np.unique(points))
    return (
        f"Uniform normals on the circle (left) are mapped to points of a curve (right) that are "
        f"dense where |κ| is large; a normal and its points have the same number. Blue points "
        f"have a positive curvature, orange points a negative one. Of the {NORMALS} normals "
        f"{counts} points. Each normal has one blue point more than orange ones, since the tangent "
        f"of the curve turns round once. The curve has {samples.report.inflections} "
        f"inflections; in polar coordinates it is "
        f"$`r = {latex_of(RADIUS)}`$."
    )


def figure_5() -> tuple[Figure, str]:
    """Draw the polygons through points uniform in the parameter, and with uniform normals."""
    figure, (axes,) = panels(
        6.6, 2.75, 1, 2, left=0.01, right=0.99, bottom=0.13, top=0.91, wspace=0.03
    )
    normal = by_normals(VERTICES)
    parameter = by_parameter(len(normal))
    axes[0].set_title("Uniform in the parameter", pad=4)
    axes[1].set_title("Uniform normals", pad=4)
    for panel, places in zip(axes, (parameter, normal), strict=True):
        draw_polygon(panel, places)
        style = {"transform": panel.transAxes, "ha": "center", "va": "top"}
        panel.text(0.5, -0.02, measured(places), **style)
    return figure, (
        f"Two polygons with {len(normal) - 1} vertices on the curve of Fig. 4 (thin). Left: "
        f"through points that are uniform in the parameter, the polar angle. Right: through points "
        f"with uniform normals. The numbers are the largest distance of the curve from the "
        f"polygon and the largest angle between curve and polygon: {measured(parameter)} on the "
        f"left, {measured(normal)} on the right. Points that are uniform in arc length would give "
        f"{measured(by_length(len(normal) - 1))}. On other curves uniform normals need not "
        f"give the smaller distance: see [curves](guides/more.md#planar-curves)."
    )


def measured(places: Floats) -> str:
    """Return the largest distance and angle between the curve and the polygon, as a text."""
    dense, vertices = np.linspace(places[0], places[-1], DENSE), derivatives(places)[0]
    point, tangent, _ = derivatives(dense)
    edge = np.clip(np.searchsorted(places, dense) - 1, 0, len(places) - 2)
    (a, b), (x, y) = np.diff(vertices, axis=0)[edge].T, tangent.T
    angle = np.degrees(np.abs(np.arctan2(a * y - b * x, a * x + b * y))).max()
    distance = shapely.distance(shapely.LineString(vertices), shapely.points(point)).max()
    return f"distance {distance:#.3g}, angle {angle:#.3g}°"


def by_length(edges: int) -> Floats:
    """Return the parameters (edges + 1,) of points at equal distances along the curve."""
    places = by_parameter(FINE)
    steps = np.hypot(*np.diff(derivatives(places)[0], axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    return np.interp(np.linspace(0.0, length[-1], edges + 1), length, places)


def draw_polygon(axes: Axes, places: Floats) -> None:
    """Draw the polygon through the points at parameters, the curve behind it."""
    points = derivatives(by_parameter(SMOOTH))[0]
    vertices = derivatives(places)[0]
    axes.plot(*points.T, color=ELLIPTIC, linewidth=0.8, zorder=2)
    axes.plot(*vertices.T, color=INK, linewidth=1.1, marker="o", markersize=3.0, zorder=3)


def draw_curve(axes: Axes, points: Floats, closed: bool = False) -> None:
    """Draw a curve through many points."""
    axes.plot(*np.concatenate([points, points[:closed]]).T, color=INK, linewidth=0.8, zorder=3)


def segments(axes: Axes, starts: Floats, ends: Floats, **style: object) -> None:
    """Draw segments between points (k, 2)."""
    axes.add_collection(LineCollection(list(np.stack([starts, ends], axis=1)), zorder=2, **style))


def dots(axes: Axes, points: Floats, numbered: Floats, colour: str) -> None:
    """Draw points (k, 2), the numbered ones among them larger."""
    axes.scatter(*points.T, s=11, color=colour, linewidths=0, zorder=4)
    axes.scatter(*numbered.T, s=28, color=colour, linewidths=0, zorder=5)


def labels(axes: Axes, points: Floats, directions: Floats, indices: NDArray[np.int64]) -> None:
    """Write the numbers of normals beside points (k, 2), in the directions of unit vectors."""
    for point, direction, index in zip(points, directions, indices, strict=True):
        axes.annotate(
            str(index // EVERY + 1), point, xytext=8 * direction, textcoords="offset points",
            ha="center", va="center", path_effects=HALO, zorder=8,
        )  # fmt: skip
