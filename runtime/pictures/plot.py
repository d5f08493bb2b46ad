"""One picture of a sampling: the surface with its samples, the unit sphere with their normals."""

from __future__ import annotations

import math
import os
import textwrap
import warnings
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..density.request import checked_request
from ..directions.unit import as_normals
from ..errors import InputError
from ..extras import check_extra
from ..files import paths
from ..fitting.fit import spline_of
from ..samples import Samples
from ..sampling import sample_and_normals
from ..splines.spline import Spline
from ..surface.surface import Surface
from .globe import draw_globe, view_of
from .palette import ELLIPTIC, HYPERBOLIC, INK, NO_SAMPLE, PALE, SCALE, STYLE
from .scene import AZIMUTH, ELEVATION, Scene

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, Normalize
    from matplotlib.figure import Figure

__all__ = ["SUFFIXES", "check_target", "plot", "plot_samples"]

SUFFIXES = (".png", ".pdf", ".svg")

# The layout, in inches: the centres of both halves, and the size of their contents.
WIDTH, HEIGHT, MIDDLE, TITLES, LEGENDS = 9.0, 4.9, 2.45, 4.17, 0.56
LEFT, ROOM_WIDTH, ROOM_HEIGHT = 2.4, 4.1, 3.1
RIGHT, RADIUS = 6.8, 1.35
DOTS_PER_INCH = {".png": 200, ".pdf": 300, ".svg": 300}

LONGEST_LINE = 140  # letters of the summary

ISOLINES = 16  # parameter lines along u and v
ROBUST = 95.0  # the percentile of |K| at the ends of the colour scale


def plot(
    surface: Surface | Spline,
    path: str | os.PathLike[str],
    normals: ArrayLike | None = None,
    *,
    count: int | None = None,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> Samples:
    """Sample a surface, draw it with its samples to a .png, .pdf or .svg file, return the samples.

    The other arguments are those of `sample`. Raises what `sample` and `plot_samples` raise; the
    path is checked before any work is done.
    """
    check_target(path)
    request = checked_request(normals, count, angle, coverage, density, relax, threads)
    samples, directions = sample_and_normals(
        surface, request, cells=cells, on=on, threads=threads, progress=progress
    )
    # Of several pieces the lines are drawn on one spline, which rounds the edges between them.
    spline = spline_of(surface, cells) if samples.spline is None else samples.spline
    plot_samples(samples, spline, directions, path)
    return samples


def plot_samples(
    samples: Samples, spline: Spline, normals: ArrayLike, path: str | os.PathLike[str]
) -> None:
    """Draw samples of a spline, and the prescribed normals, to a .png, .pdf or .svg file.

    On the left are the visible samples, coloured by Gaussian curvature. On the right is the unit
    sphere with the normals, seen from the same direction, or turned towards their mean if they are
    concentrated. The heights of a surface that are very small or large relative to its width are
    rescaled, and the label of the axis gives the factor.

    Raises UnknownNameError for another suffix, FileError if the file cannot be written, InputError
    if the samples do not belong to the normals, and MissingExtraError if matplotlib is not
    installed.
    """
    check_target(path)
    alone = len(samples) > 0 and np.size(normals) == 0  # no prescribed normals
    directions = samples.normals[:0] if alone else as_normals(normals)
    if len(samples) and int(samples.normal_index.max()) >= len(directions):
        raise InputError("the samples do not belong to these normals: there are too few normals.")
    import matplotlib.style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    suffix = Path(path).suffix.lower()
    undated = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[suffix]
    # From matplotlib's defaults, so that a picture does not depend on the user's settings.
    with (
        matplotlib.style.context(["default", STYLE]),
        warnings.catch_warnings(),
        np.errstate(all="ignore"),
    ):
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # in the name of a surface
        figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DOTS_PER_INCH[suffix])
        FigureCanvasAgg(figure)
        name = " ".join(samples.report.surface.split())
        _write(figure, WIDTH / 2, 4.64, name if len(name) <= 80 else name[:79] + "…", fontsize=11)
        lines = textwrap.wrap(samples.summary(), LONGEST_LINE)
        for k, line in enumerate(lines):
            place = 4.43 + 0.03 * (len(lines) - 1) - 0.12 * k
            _write(figure, WIDTH / 2, place, line, fontsize=7.5, color=PALE)
        _draw_surface(figure, samples, spline)
        _draw_sphere(figure, samples, directions)
        with paths.atomic_path(path) as temporary:
            figure.savefig(temporary, format=suffix[1:], metadata=undated)


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise what `plot_samples` would raise later, for its path or if matplotlib is missing."""
    paths.check_target(path, SUFFIXES)
    check_extra("matplotlib", "plot", "a picture")


def _write(figure: Figure, x: float, y: float, text: str, **style: Any) -> None:  # noqa: ANN401
    """Write a text at a position in inches; dollar signs in it are not mathematics."""
    figure.text(x / WIDTH, y / HEIGHT, text, ha="center", parse_math=False, **style)


def _box(x: float, y: float, width: float, height: float) -> tuple[float, float, float, float]:
    """Return a rectangle, given by its centre and size in inches, in fractions of the figure."""
    return (x - width / 2) / WIDTH, (y - height / 2) / HEIGHT, width / WIDTH, height / HEIGHT


# ── The left half: the surface ───────────────────────────────────────────────────────────────────


def _draw_surface(figure: Figure, samples: Samples, spline: Spline) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    scene = Scene.of(spline)
    axes: Any = figure.add_axes(_box(LEFT, MIDDLE, 4.5, 4.5), projection="3d")
    axes.computed_zorder = False
    _frame(axes, scene)
    greys = (0.60 + 0.33 * scene.brightness)[:, None] * [0.98, 0.99, 1.0]
    # Quadrangles are rasterized, also in .pdf and .svg files: seams would show between them.
    axes.add_collection3d(
        Poly3DCollection(
            scene.quadrangles, facecolors=greys, edgecolors=greys, linewidths=0.3,
            rasterized=True, zorder=1,
        )
    )  # fmt: skip
    axes.add_collection3d(
        Line3DCollection(_isolines(scene), colors="white", linewidths=0.4, zorder=2)
    )
    if len(samples) == 0:
        _write(figure, LEFT, TITLES, "no samples")
        return
    norm, scale, clipped = _colours(samples.gaussian_curvature)
    visible = samples[scene.visible(samples.points)]
    area = min(max(12_000 / len(samples), 0.5), 16.0)
    axes.scatter(
        *visible.points.T, c=visible.gaussian_curvature, cmap=scale, norm=norm, s=area,
        depthshade=False, edgecolors=INK, linewidths=min(0.2, 0.09 * math.sqrt(area)), zorder=3,
    )  # fmt: skip
    _draw_scale(figure, norm, scale, clipped)
    _write(figure, LEFT, TITLES, f"{len(visible):,} of {len(samples):,} samples visible")


def _frame(axes: Any, scene: Scene) -> None:  # noqa: ANN401
    """Set the viewer, the limits, the same scale along all axes, and the labels."""
    from matplotlib.ticker import FixedLocator, MaxNLocator

    points = scene.mesh.reshape(-1, 3)
    factors = np.array([1.0, 1.0, scene.factor])
    extent = np.ptp(points, axis=0) * factors
    margin = np.maximum(extent, 0.02 * extent.max() or 1.0) / factors / 2
    limits = (points.min(axis=0) + points.max(axis=0)) / 2 + np.outer([-1.0, 1.0], margin)
    axes.set_proj_type("ortho")
    axes.view_init(ELEVATION, AZIMUTH)
    axes.set(xlim=limits[:, 0], ylim=limits[:, 1], zlim=limits[:, 2])
    axes.set_box_aspect(2 * margin * factors, zoom=_zoom(axes, 2 * margin * factors))
    axes.patch.set_visible(False)

    label = "z"
    if scene.factor != 1.0:
        by = max(scene.factor, 1 / scene.factor)
        label = f"z ({'exaggerated' if scene.factor > 1.0 else 'reduced'} {by:g}×)"
    low = extent[2] < 0.7 * extent.max()  # then matplotlib puts the label of z far away
    names = (axes.xaxis, "x", 1), (axes.yaxis, "y", 1), (axes.zaxis, label, -4 if low else 3)
    for k, (axis, name, distance) in enumerate(names):
        axis.set_label_text(name)
        axis.labelpad = distance
        flat = extent[k] < 0.02 * extent.max()
        middle = FixedLocator([limits[:, k].mean()])
        axis.set_major_locator(middle if flat else MaxNLocator(4, prune="both"))
    axes.tick_params(labelsize=6.5, pad=-1, colors=INK)


def _zoom(axes: Any, aspect: NDArray[np.float64]) -> float:  # noqa: ANN401
    """Return the zoom at which the box fills its part of the figure."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform

    axes.set_box_aspect(aspect)
    corners = np.array(list(product(axes.get_xlim(), axes.get_ylim(), axes.get_zlim())))
    x, y, z = corners.T
    across, along, _ = proj_transform(x, y, z, axes.get_proj())
    pixels = axes.transData.transform(np.stack([across, along], axis=1))
    width, height = np.ptp(pixels, axis=0) / axes.figure.dpi
    return float(min(ROOM_WIDTH / width, ROOM_HEIGHT / height))


def _isolines(scene: Scene) -> NDArray[np.float64]:
    """Return the visible segments (k, 2, 3) of some parameter lines."""
    pieces = []
    for mesh in (scene.mesh, np.swapaxes(scene.mesh, 0, 1)):
        lines = mesh[np.linspace(0, len(mesh) - 1, ISOLINES + 1).round().astype(int)]
        visible = scene.visible(lines.reshape(-1, 3)).reshape(lines.shape[:2])
        both = visible[:, 1:] & visible[:, :-1]
        pieces.append(np.stack([lines[:, :-1], lines[:, 1:]], axis=2)[both])
    return np.concatenate(pieces)


def _colours(K: NDArray[np.float64]) -> tuple[Normalize, Colormap, bool]:
    """Return the colour scale of curvatures, symmetric to zero, and whether some exceed it."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    sizes = np.append(np.abs(K[np.isfinite(K)]), 0.0)
    largest, limit = float(sizes.max()), float(np.percentile(sizes, ROBUST))
    if largest <= 1.25 * limit or limit == 0.0:
        limit = largest or 1.0
    scale = LinearSegmentedColormap.from_list("curvature", SCALE)
    return Normalize(-limit, limit), scale, largest > limit


def _draw_scale(figure: Figure, norm: Normalize, scale: Colormap, clipped: bool) -> None:
    from matplotlib.cm import ScalarMappable

    exponent = math.floor(math.log10(norm.vmax or 1.0))
    exponent = 0 if -2 <= exponent <= 3 else exponent
    bar: Any = figure.colorbar(
        ScalarMappable(norm, scale),
        cax=figure.add_axes(_box(LEFT, LEGENDS + 0.06, 2.7, 0.1)),
        orientation="horizontal",
        extend="both" if clipped else "neither",
        format=lambda value, _: f"{value / 10.0**exponent:g}".replace("-", "−"),
    )
    unit = rf"$10^{{{exponent}}}$" if exponent else "1"
    bar.set_label(f"Gaussian curvature $K$ ({unit}/length²)")
    bar.outline.set_linewidth(0.4)
    bar.ax.tick_params(width=0.4, length=2.5, labelsize=7)


# ── The right half: the unit sphere ──────────────────────────────────────────────────────────────


class _Kind(NamedTuple):
    """Normals that are drawn in the same way: in a colour, as rings or as discs."""

    label: str
    normals: NDArray[np.float64]
    colour: str
    ring: bool


def _draw_sphere(figure: Figure, samples: Samples, normals: NDArray[np.float64]) -> None:
    from matplotlib.lines import Line2D

    index, missed = samples.normal_index, np.ones(len(normals), dtype=bool)
    missed[index[index >= 0]] = False
    # One normal may have samples of both kinds: a disc with a ring round it.
    kinds = [
        _Kind("no sample", normals[missed], NO_SAMPLE, False),
        _Kind("elliptic", samples.normals[samples.elliptic], ELLIPTIC, True),
        _Kind("hyperbolic", samples.normals[samples.hyperbolic], HYPERBOLIC, False),
    ]
    axes = figure.add_axes(_box(RIGHT, MIDDLE, 2.6 * RADIUS, 2.6 * RADIUS))
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    view = view_of(samples.normals if len(samples) else normals)
    draw_globe(axes, view)
    area = _marker_area(normals if len(normals) else samples.normals)
    handles = []
    for height, kind in enumerate(kinds):
        size = area * (2.4 if kind.ring else 1.0)
        line = min(0.6, 0.3 * math.sqrt(size)) if kind.ring else 0.0
        face = "none" if kind.ring else kind.colour
        seen = np.unique(kind.normals, axis=0) @ view.T
        front, back = seen[seen[:, 2] >= 0.0], seen[seen[:, 2] < 0.0]
        axes.scatter(
            front[:, 0], front[:, 1], s=size, zorder=6 + 0.1 * height,
            facecolors=face, edgecolors=kind.colour, linewidths=line,
        )  # fmt: skip
        # Normals on the far side are seen through the globe.
        axes.scatter(
            back[:, 0], back[:, 1], s=0.7 * area, zorder=1 + 0.1 * height,
            color=kind.colour, linewidths=0.0,
        )  # fmt: skip
        if len(kind.normals):
            handles.append(
                Line2D(
                    [], [], marker="o", markersize=5.0 if kind.ring else 3.5, linestyle="",
                    markeredgecolor=kind.colour, markerfacecolor=face,
                    label=f"{kind.label} ({len(kind.normals):,})",
                )
            )  # fmt: skip
    figure.legend(
        handles=[*handles[1:], handles[0]] if missed.any() else handles,
        loc="center", bbox_to_anchor=(RIGHT / WIDTH, LEGENDS / HEIGHT), ncols=3,
        frameon=False, handletextpad=0.1, columnspacing=1.4,
    )  # fmt: skip
    whose = "their normals" if len(samples) else "the prescribed normals"
    _write(figure, RIGHT, TITLES, f"{whose}, on the unit sphere")


def _marker_area(normals: NDArray[np.float64]) -> float:
    """Return the area of a marker in points², such that markers do not overlap on the sphere."""
    mean = normals.mean(axis=0)
    length = float(np.linalg.norm(mean))
    depth = 1.0 - float((normals @ mean).min()) / length if length > 1e-3 else 2.0
    room = 2 * math.pi * max(depth, 0.01) * (72 * RADIUS) ** 2
    return float(np.clip(0.12 * room / len(normals), 0.6, 8.0))
