"""The picture of a Gauss map: its folds on the surface, and their images on the unit sphere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.checks import finite_array
from ...runtime.base.extras import check_extra
from ...runtime.base.wording import plural
from ...runtime.domain.trim import polygons_of
from ...runtime.map import GaussMap
from ..gauss_map.image_curve import ImageCurve
from ..sampling.sample import sample
from .colours import CURVATURE, colours_of
from .palette import FILLING, INK, MARK
from .plot import style
from .scene import VIEW, Scene, scene_of_samples
from .scene import view as rows_of_view
from .sphere_half import draw_globe, view_of
from .surface_half import draw_surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COUNT = 2_000  # of samples, coloured by K
SIZE, ROOM, DOTS_PER_INCH = (8.0, 4.4), (3.6, 2.9), 200  # of the figure, and of the surface
POINT = 0.02  # an image smaller than this is drawn as a point


def plot(self: GaussMap, *, view: Sequence[float] = VIEW) -> Figure:
    """Draw the parabolic curves on the surface, and their images, the folds, on the unit sphere.

    On the right is the surface with samples coloured by K, which changes its sign at the parabolic
    curves; on the left are the normals on the front of the sphere, and the images of the parabolic
    curves with their cusps. The number of points with a normal changes by two at a fold, and by one
    at the image of a boundary. Parts hidden by the surface are not drawn; parts behind the sphere
    are pale.

    Parameters
    ----------
    view : (float, float), default (28, -55)
        Elevation and azimuth of the viewer, in degrees.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, as of `gaussmap.plot`.

    Raises
    ------
    MissingExtraError
        Without Matplotlib: ``pip install "gaussmap[plot]"``.
    InputError
        For an unusable view, and for parts.

    See Also
    --------
    GaussMap.folds, GaussMap.border_image : the curves, as arrays.

    Examples
    --------
    >>> import gaussmap as gm
    >>> figure = gm.GaussMap("wavy_graph").plot(view=(60, -55))
    >>> figure.savefig("folds.png")

    """
    check_extra("matplotlib", "plot", "a picture")
    elevation, azimuth = finite_array(view, (2,), "view").tolist()
    folds, borders = self.folds(), _borders(self)
    samples = sample(self.surface or self.spline, COUNT, density="uniform")
    scene = scene_of_samples(samples, None, rows_of_view(elevation, azimuth))
    from .figure import Picture

    with style():
        figure = Picture(figsize=SIZE, dpi=DOTS_PER_INCH)
        right: Any = figure.add_axes((0.42, 0.0, 0.56, 0.92), projection="3d")
        visible = scene.visible(samples.points)
        colours = colours_of(samples, CURVATURE)
        draw_surface(right, samples, scene, colours, (elevation, azimuth), visible, room=ROOM)
        left = figure.add_axes((0.02, 0.08, 0.40, 0.80), aspect="equal")
        left.set(xlim=(-1.35, 1.35), ylim=(-1.35, 1.35))
        left.set_axis_off()
        seen_from = view_of(samples.normals, scene.view)
        draw_globe(left, seen_from)
        normals = samples.normals @ seen_from.T
        front = normals[:, 2] > 0.0
        left.scatter(
            *normals[front, :2].T, c=colours.values[front], cmap=colours.scale, norm=colours.norm,
            s=2.0, linewidths=0.0, zorder=5,
        )  # fmt: skip
        for curves, colour in ((borders, FILLING), (folds, INK)):
            for curve in curves:
                _draw_on_surface(right, scene, curve, colour)
                _draw_on_sphere(left, curve.normals @ seen_from.T, curve.cusps, colour)
        cusps = sum(len(x.cusps) for x in folds)
        text = f"{plural(len(folds), 'fold')} with {plural(cusps, 'cusp')}"
        figure.text(0.22, 0.93, text, ha="center", color=INK)
        if borders:
            figure.text(0.22, 0.04, "images of the boundary", ha="center", color=FILLING)
        figure.text(0.7, 0.93, "parabolic curves, and samples by K", ha="center", color=INK)
    return figure


def _borders(gauss_map: GaussMap) -> tuple[ImageCurve, ...]:
    """Return the images of the boundary; none if a trim is not given by loops."""
    trim = getattr(gauss_map.surface, "trim", None)
    if trim is not None and not all(polygons_of(x) for x in trim.parts):
        return ()
    return gauss_map.border_image()


def _draw_on_surface(axes: Any, scene: Scene, curve: ImageCurve, colour: str) -> None:  # noqa: ANN401
    """Draw the visible part of a curve, and its cusps, into three-dimensional axes."""
    seen = scene.visible(curve.points)
    line = np.where(seen[:, None], curve.points, np.nan)
    axes.plot(*line.T, color=colour, linewidth=1.2, zorder=4)
    _draw_cusps(axes, line[curve.cusps])


def _draw_on_sphere(axes: Axes, image: Array, cusps: Indices, colour: str) -> None:
    """Draw a curve (k, 3) on the sphere, seen along the third axis; its far parts are pale."""
    front = image[:, 2:] >= 0.0
    marker = "o" if float(np.ptp(image, axis=0).max()) < POINT else ""
    for part, alpha, order in ((front, 1.0, 6), (~front, 0.35, 1)):
        line = np.where(part, image, np.nan)[:, :2]
        axes.plot(
            *line.T, color=colour, alpha=alpha, linewidth=1.0, marker=marker, markersize=3.0,
            zorder=order,
        )  # fmt: skip
    _draw_cusps(axes, image[cusps][front[cusps, 0], :2])


def _draw_cusps(axes: Any, places: Array) -> None:  # noqa: ANN401
    axes.plot(
        *places.T, linestyle="", marker="o", markersize=4.0, color=MARK, markeredgecolor=INK,
        markeredgewidth=0.6, zorder=8,
    )  # fmt: skip
