"""The right of a picture: the surface with its visible samples."""

import math
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from .colours import Colours, numbers_in_file
from .marked import Marked
from .palette import INK, MARK
from .scene import Scene

# Numbers of at least LONG have long labels. Axes shorter than SHORT times the longest one have
# fewer labels, axes shorter than FLAT times the longest one have one label.
LONG, SHORT, FLAT = 1e5, 0.35, 0.15
ARROWS, ARROW = 6, 0.16  # at most this many, with a length relative to the size of the surface
View = tuple[float, float]  # elevation and azimuth of the viewer, in degrees
Room = tuple[float, float]  # width and height in inches


def draw_surface(
    axes: Any,  # noqa: ANN401
    samples: Samples,
    scene: Scene,
    colours: Colours,
    view: View,
    visible: NDArray[np.bool_],
    marked: Marked | None = None,
    room: Room | None = None,
) -> None:
    """Draw the surface and its visible samples, a mask (N,), into three-dimensional axes.

    The surface fills the room (width and height), if given. Samples that fill gaps are smaller than
    samples at normals.
    """
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    axes.computed_zorder = False
    _frame(axes, scene, view, room, samples.report.unit)
    for layer in scene.in_layers():
        greys = (0.60 + 0.33 * layer.brightness)[:, None] * [0.98, 0.99, 1.0]
        # Quadrangles are rasterized, also in .pdf and .svg files; otherwise seams would be seen
        # between them.
        axes.add_collection3d(
            Poly3DCollection(
                layer.quadrangles, facecolors=greys, edgecolors=greys, linewidths=0.3,
                rasterized=True, zorder=1,
            )
        )  # fmt: skip
    if len(lines := scene.visible_lines):
        axes.add_collection3d(Line3DCollection(lines, colors="white", linewidths=0.4, zorder=2))
    area = min(max(12_000 / max(len(samples), 1), 0.5), 16.0)
    areas = np.where(samples.kind[visible] == "filling", 0.5 * area, area)
    axes.scatter(
        *samples.points[visible].T, c=colours.values[visible], cmap=colours.scale,
        norm=colours.norm, s=areas, depthshade=False, edgecolors=INK,
        linewidths=np.clip(0.12 * np.sqrt(areas), 0.15, 0.35), zorder=3,
    )  # fmt: skip
    if marked is not None:
        _mark(axes, samples.points[marked.visible], marked.normal, scene, math.sqrt(area))


def draw_face_numbers(axes: Any, samples: Samples, visible: NDArray[np.bool_]) -> None:  # noqa: ANN401
    """Write on each face its index in the file, at a visible sample near the middle of the face."""
    from matplotlib.patheffects import withStroke

    assert samples.face_index is not None
    faces, halo = samples.face_index[visible], [withStroke(linewidth=1.5, foreground="white")]
    found = np.unique(faces)
    for face, number in zip(found, numbers_in_file(samples, found), strict=True):
        points = samples.points[visible][faces == face]
        middle = np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()
        axes.text(
            *points[middle], str(number), fontsize=6.5, ha="center", va="center", color=INK,
            path_effects=halo, zorder=5,
        )  # fmt: skip


def _mark(
    axes: Any,  # noqa: ANN401
    points: NDArray[Any],
    normal: NDArray[np.float64],
    scene: Scene,
    size: float,
) -> None:
    """Mark points that share a normal.

    Arrows show the normal if the points are few and heights are not rescaled. The marks of many
    points have about the diameter of samples, `size`, in typographic points.
    """
    few = len(points) <= ARROWS
    if few and scene.factor == 1.0:
        length = ARROW * float(np.ptp(scene.quadrangles.reshape(-1, 3), axis=0).max())
        for point in points:
            axes.quiver(
                *point, *(length * normal), color=INK, linewidth=1.0, arrow_length_ratio=0.3,
                zorder=4,
            )  # fmt: skip
    diameter = 5.8 if few else min(1.3 * size, 3.5)
    axes.plot(
        *points.T, linestyle="", marker="o", markersize=diameter, color=MARK,
        markeredgecolor=INK, markeredgewidth=0.9 if few else 0.3, zorder=5,
    )  # fmt: skip


def _frame(
    axes: Any,  # noqa: ANN401
    scene: Scene,
    view: View,
    room: Room | None,
    unit: str | None,
) -> None:
    """Set the viewer, the limits, the same scale along all axes, and the labels."""
    from matplotlib.ticker import FixedLocator, MaxNLocator

    points = scene.quadrangles.reshape(-1, 3)
    factors = np.array([1.0, 1.0, scene.factor])
    extent = np.ptp(points, axis=0) * factors
    margin = np.maximum(extent, 0.02 * extent.max() or 1.0) / factors / 2
    limits = (points.min(axis=0) + points.max(axis=0)) / 2 + np.outer([-1.0, 1.0], margin)
    axes.set_proj_type("ortho")
    axes.view_init(*view)
    axes.set(xlim=limits[:, 0], ylim=limits[:, 1], zlim=limits[:, 2])
    aspect = 2 * margin * factors
    axes.set_box_aspect(aspect, zoom=_zoom(axes, aspect, room) if room else 1.0)
    axes.patch.set_visible(False)

    label = of_length = f" ({unit})" if unit else ""
    if scene.factor != 1.0:
        by = max(scene.factor, 1 / scene.factor)
        label += f" ({'exaggerated' if scene.factor > 1.0 else 'reduced'} {by:g}×)"
    low = extent[2] < 0.7 * extent.max()  # then matplotlib would put the label of z far away
    names = (
        (axes.xaxis, f"x{of_length}", 1),
        (axes.yaxis, f"y{of_length}", 1),
        (axes.zaxis, f"z{label}", -4 if low else 3),
    )
    for k, (axis, name, distance) in enumerate(names):
        axis.set_label_text(name)
        axis.labelpad = distance
        flat = extent[k] < FLAT * extent.max()
        step = 10.0 ** np.floor(np.log10(np.ptp(limits[:, k]) / 4.0))
        middle = FixedLocator([step * np.round(limits[:, k].mean() / step)])
        # There are fewer labels if they are long or the axis is short, since they would overlap.
        # Labels are complete numbers, not differences from an offset.
        long = np.abs(limits[:, k]).max() >= LONG or extent[k] < SHORT * extent.max()
        axis.set_major_locator(middle if flat else MaxNLocator(2 if long else 4, prune="both"))
        axis.set_major_formatter(lambda value, _: f"{value:.7g}".replace("-", "−"))
    axes.tick_params(labelsize=6.5, pad=-1, colors=INK)


def _zoom(axes: Any, aspect: NDArray[np.float64], room: Room) -> float:  # noqa: ANN401
    """Return the zoom at which the box of the axes fills the room, a width and height in inches."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform

    axes.set_box_aspect(aspect)
    corners = np.array(list(product(axes.get_xlim(), axes.get_ylim(), axes.get_zlim())))
    x, y, z = corners.T
    across, along, _ = proj_transform(x, y, z, axes.get_proj())
    pixels = axes.transData.transform(np.stack([across, along], axis=1))
    width, height = np.ptp(pixels, axis=0) / axes.figure.dpi
    return float(min(room[0] / width, room[1] / height))
