"""One picture of a sampling: the surface with its samples, and the unit sphere with their normals.

Matplotlib draws in three dimensions without a depth test. What hides what is therefore decided
here, by the triangles of a mesh of the surface that lie between a sample and the viewer.
"""

from __future__ import annotations

import importlib.util
import math
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import io
from .errors import GaussmapWarning, InputError, MissingExtraError
from .lattice import Lattice
from .samples import Samples
from .sampling import sample
from .sphere import as_normals
from .spline import Spline, fit
from .surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, Normalize
    from matplotlib.figure import Figure

__all__ = ["SUFFIXES", "check_target", "plot", "plot_samples"]

SUFFIXES = (".png", ".pdf", ".svg")

# The layout, in inches: the middles of both halves, and how much room their contents have.
WIDTH, HEIGHT, MIDDLE, TITLES, LEGENDS = 9.0, 4.9, 2.45, 4.17, 0.56
LEFT, ROOM_WIDTH, ROOM_HEIGHT = 2.4, 4.1, 3.1
RIGHT, RADIUS = 6.8, 1.35
DOTS_PER_INCH = {".png": 200, ".pdf": 300, ".svg": 300}

# Blue for elliptic and orange for hyperbolic, in both halves: the pair that everybody can tell
# apart (Okabe and Ito). The neutral colour of the scale stands for zero curvature.
ELLIPTIC, HYPERBOLIC, NO_SAMPLE = "#0072b2", "#d55e00", "#a8a8a8"
SCALE = ("#7a2e00", HYPERBOLIC, "#f3b183", "#f7f7f7", "#8cc4e8", ELLIPTIC, "#003c66")
INK, PALE, FAINT, GLOBE = "#333333", "#8a8a8a", "#e4e4e4", "#eceef0"
STYLE = {
    "axes.edgecolor": PALE,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.5,
    **{f"axes3d.{axis}axis.panecolor": (1.0, 1.0, 1.0, 0.0) for axis in "xyz"},
    "font.size": 8.0,
    "grid.color": FAINT,
    "grid.linewidth": 0.4,
    "svg.hashsalt": "gaussmap",
    "text.color": INK,
}

ELEVATION, AZIMUTH = math.radians(28.0), math.radians(-55.0)  # of the viewer
MESH, MOST_MESH, ISOLINES = 112, 224, 16  # quadrangles along u and v: as many as cells, within this
# A surface hides a sample if it is nearer to the viewer by this part of the picture's diameter.
HIDING = 0.01
# A height below or above these parts of the width is exaggerated or reduced, to about the second.
LOW, LOW_WANTED = 0.1, 0.25
HIGH, HIGH_WANTED = 10.0, 2.0
ROBUST = 95.0  # the percentile of |K| at the ends of the colour scale


def plot(
    surface: Surface | Spline,
    path: str | os.PathLike[str],
    normals: ArrayLike | None = None,
    *,
    count: int | None = None,
    cells: Sequence[int] | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> Samples:
    """Sample a surface, draw it with its samples to a .png, .pdf or .svg file, return the samples.

    The other arguments are those of `sample`. Raises what `sample` and `plot_samples` raise; what
    is wrong with the path is known before any work is done.
    """
    check_target(path)
    if isinstance(surface, Spline) and cells is not None:
        raise InputError("cells=... is for surfaces; this spline has its cells already.")
    spline = surface if isinstance(surface, Spline) else fit(surface, cells)
    samples = sample(spline, normals, count=count, threads=threads, progress=progress)
    if normals is not None:
        directions = as_normals(normals)
    else:
        # Samples do not tell which normals were asked in vain: sample again, by known normals.
        lattice = Lattice.around(spline)
        directions = lattice.normals(lattice.density_of(samples.report.normals or 1))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GaussmapWarning)
            samples = sample(spline, directions, threads=threads, progress=progress)
    plot_samples(samples, spline, directions, path)
    return samples


def plot_samples(
    samples: Samples, spline: Spline, normals: ArrayLike, path: str | os.PathLike[str]
) -> None:
    """Draw samples of a spline, and the normals that were asked, to a .png, .pdf or .svg file.

    On the left are the samples that the surface does not hide, coloured by Gaussian curvature. On
    the right is the unit sphere with the normals, seen from the same side or, if they point into
    similar directions, more from theirs. A surface whose height is very small or large against its
    width is drawn with other heights, and the axis says so.

    Raises UnknownNameError for another suffix, FileError if the file cannot be written, InputError
    if the samples do not belong to the normals, and MissingExtraError if matplotlib is not
    installed.
    """
    check_target(path)
    directions = as_normals(normals)
    if len(samples) and int(samples.normal_index.max()) >= len(directions):
        raise InputError("the samples do not belong to these normals: there are too few normals.")
    import matplotlib.style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    suffix = Path(path).suffix.lower()
    undated = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[suffix]
    # From matplotlib's defaults: a picture does not depend on the settings of who makes it.
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
        _write(figure, WIDTH / 2, 4.43, samples.summary(), fontsize=7.5, color=PALE)
        _draw_surface(figure, samples, spline)
        _draw_sphere(figure, samples, directions)
        with io.atomic_path(path) as temporary:
            figure.savefig(temporary, format=suffix[1:], metadata=undated)


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise now what `plot_samples` would raise later: for its path, or for lack of matplotlib."""
    io.check_target(path, SUFFIXES)
    if importlib.util.find_spec("matplotlib") is None:
        raise MissingExtraError(
            'pictures need matplotlib, but it is not installed; run: pip install "gaussmap[plot]"'
        )


def _write(figure: Figure, x: float, y: float, text: str, **style: Any) -> None:  # noqa: ANN401
    """Write a text at a place in inches, whatever dollars it holds."""
    figure.text(x / WIDTH, y / HEIGHT, text, ha="center", parse_math=False, **style)


def _box(x: float, y: float, width: float, height: float) -> tuple[float, float, float, float]:
    """Return the rectangle round a place, all in inches, in parts of the figure."""
    return (x - width / 2) / WIDTH, (y - height / 2) / HEIGHT, width / WIDTH, height / HEIGHT


# ── What hides what ──────────────────────────────────────────────────────────────────────────────


def _view() -> NDArray[np.float64]:
    """Return the rows right, up, and towards the viewer."""
    s, c, S, C = (f(angle) for angle in (ELEVATION, AZIMUTH) for f in (math.sin, math.cos))
    return np.array([[-S, C, 0.0], [-s * C, -s * S, c], [c * C, c * S, s]])


@dataclass(frozen=True, eq=False)
class _Scene:
    """A mesh (m + 1, n + 1, 3) of a surface, to be seen with its heights times `factor`."""

    mesh: NDArray[np.float64]
    factor: float

    @classmethod
    def of(cls, spline: Spline) -> _Scene:
        u, v = (
            np.linspace(low, high, min(max(MESH, count), MOST_MESH) + 1)
            for (low, high), count in zip(spline.domain, spline.cells, strict=True)
        )
        mesh = spline.evaluate(u[:, None], v)
        return cls(mesh, _height_factor(np.ptp(mesh.reshape(-1, 3), axis=0)))

    def seen(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points (..., 3) as right, up, and nearness to the viewer."""
        return (points * [1.0, 1.0, self.factor]) @ _view().T

    @cached_property
    def quadrangles(self) -> NDArray[np.float64]:
        """The quadrangles (Q, 4, 3) of the mesh, their corners going round."""
        m = self.mesh
        corners = m[:-1, :-1], m[1:, :-1], m[1:, 1:], m[:-1, 1:]
        return np.stack([x.reshape(-1, 3) for x in corners], axis=1)

    @cached_property
    def triangles(self) -> NDArray[np.float64]:
        """The halves (T, 3, 3) of the quadrangles as they are seen."""
        seen = self.seen(self.quadrangles)
        return np.concatenate([seen[:, [0, 1, 2]], seen[:, [0, 2, 3]]])

    @cached_property
    def brightness(self) -> NDArray[np.float64]:
        """How much light each quadrangle gets, 0 … 1, from behind the viewer's left shoulder."""
        a, b, c, d = np.moveaxis(self.seen(self.quadrangles), 1, 0)
        size = np.abs([c - a, d - b]).max() or 1.0
        normals = np.cross((c - a) / size, (d - b) / size)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals /= np.where(length > 0.0, length, 1.0)
        normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # both sides of a surface are lit
        lamp = np.array([-0.45, 0.6, 0.7])
        return np.clip(normals @ (lamp / np.linalg.norm(lamp)), 0.0, 1.0)

    def visible(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Say which points (P, 3) of the surface the surface does not hide."""
        seen = self.seen(points)
        diameter = float(np.linalg.norm(np.ptp(self.triangles.reshape(-1, 3), axis=0)))
        return seen[:, 2] >= _front(self.triangles, seen[:, :2]) - HIDING * diameter


def _front(triangles: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how near the nearest of the triangles (T, 3, 3) is at places (P, 2); −∞ at none."""
    flat = triangles[..., :2]
    grid = max(1, round(math.sqrt(len(triangles)) / 2))
    lowest, highest = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    step = np.where(highest > lowest, highest - lowest, 1.0) / grid

    def square(points: NDArray[np.float64]) -> NDArray[np.int64]:
        return np.clip(np.floor((points - lowest) / step), 0, grid - 1).astype(np.int64)

    # Every triangle is noted in all squares that its bounding box meets.
    first, last = square(flat.min(axis=1)), square(flat.max(axis=1))
    sizes = last - first + 1
    owner, k = _runs(sizes.prod(axis=1))
    i, j = np.divmod(k, sizes[owner, 1])
    noted = (first[owner, 0] + i) * grid + first[owner, 1] + j
    order = np.argsort(noted, kind="stable")
    starts = np.searchsorted(noted[order], np.arange(grid * grid + 1))

    own = square(places) @ [grid, 1]
    place, k = _runs(starts[own + 1] - starts[own])
    near = triangles[owner[order[starts[own][place] + k]]]
    a, b, c = np.moveaxis(near[..., :2] - places[place][:, None], 1, 0)
    weights = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
    total = weights.sum(axis=1, keepdims=True)
    weights /= np.where(total == 0.0, np.nan, total)
    inside = (weights >= -1e-9).all(axis=1)
    front = np.full(len(places), -np.inf)
    np.maximum.at(front, place[inside], np.einsum("ij,ij->i", weights, near[..., 2])[inside])
    return front


def _runs(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return each k, repeated counts[k] times, and beside it the numbers 0 … counts[k] − 1."""
    which = np.repeat(np.arange(len(counts)), counts)
    return which, np.arange(len(which)) - (np.cumsum(counts) - counts)[which]


def _cross(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    return left[:, 0] * right[:, 1] - left[:, 1] * right[:, 0]


def _height_factor(extent: NDArray[np.float64]) -> float:
    """Return the factor for heights: 1, unless the surface is very low or very high."""
    width, height = float(extent[:2].max()), float(extent[2])
    if LOW * width <= height <= HIGH * width or height <= 1e-9 * width or width <= 1e-9 * height:
        return 1.0
    if height < LOW * width:
        return _round(LOW_WANTED * width / height)
    return 1.0 / _round(height / (HIGH_WANTED * width))


def _round(factor: float) -> float:
    """Return the largest of …, 1, 2, 5, 10, 20, … that is not above a factor."""
    power = 10.0 ** math.floor(math.log10(factor))
    return power * max(digit for digit in (1, 2, 5) if digit * power <= factor * (1 + 1e-9))


# ── The left half: the surface ───────────────────────────────────────────────────────────────────


def _draw_surface(figure: Figure, samples: Samples, spline: Spline) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    scene = _Scene.of(spline)
    axes: Any = figure.add_axes(_box(LEFT, MIDDLE, 4.5, 4.5), projection="3d")
    axes.computed_zorder = False
    _frame(axes, scene)
    greys = (0.60 + 0.33 * scene.brightness)[:, None] * [0.98, 0.99, 1.0]
    # Quadrangles as an image, also in .pdf and .svg files: fine seams would show between them.
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
    _write(figure, LEFT, TITLES, f"{len(visible):,} of {len(samples):,} samples in sight")


def _frame(axes: Any, scene: _Scene) -> None:  # noqa: ANN401
    """Set the viewer, the limits, the same scale along all axes, and the labels."""
    from matplotlib.ticker import FixedLocator, MaxNLocator

    points = scene.mesh.reshape(-1, 3)
    factors = np.array([1.0, 1.0, scene.factor])
    extent = np.ptp(points, axis=0) * factors
    margin = np.maximum(extent, 0.02 * extent.max() or 1.0) / factors / 2
    limits = (points.min(axis=0) + points.max(axis=0)) / 2 + np.outer([-1.0, 1.0], margin)
    axes.set_proj_type("ortho")
    axes.view_init(math.degrees(ELEVATION), math.degrees(AZIMUTH))
    axes.set(xlim=limits[:, 0], ylim=limits[:, 1], zlim=limits[:, 2])
    axes.set_box_aspect(2 * margin * factors, zoom=_zoom(axes, 2 * margin * factors))
    axes.patch.set_visible(False)

    label = "z"
    if scene.factor != 1.0:
        by = max(scene.factor, 1 / scene.factor)
        label = f"z ({'exaggerated' if scene.factor > 1.0 else 'reduced'} {by:g}×)"
    low = extent[2] < 0.7 * extent.max()  # matplotlib puts the label of z far away then
    names = (axes.xaxis, "x", 1), (axes.yaxis, "y", 1), (axes.zaxis, label, -4 if low else 3)
    for k, (axis, name, distance) in enumerate(names):
        axis.set_label_text(name)
        axis.labelpad = distance
        flat = extent[k] < 0.02 * extent.max()
        middle = FixedLocator([limits[:, k].mean()])
        axis.set_major_locator(middle if flat else MaxNLocator(4, prune="both"))
    axes.tick_params(labelsize=6.5, pad=-1, colors=INK)


def _zoom(axes: Any, aspect: NDArray[np.float64]) -> float:  # noqa: ANN401
    """Return the zoom at which the box fills the room it has."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform

    axes.set_box_aspect(aspect)
    corners = np.array(list(product(axes.get_xlim(), axes.get_ylim(), axes.get_zlim())))
    x, y, z = corners.T
    across, along, _ = proj_transform(x, y, z, axes.get_proj())
    pixels = axes.transData.transform(np.stack([across, along], axis=1))
    width, height = np.ptp(pixels, axis=0) / axes.figure.dpi
    return float(min(ROOM_WIDTH / width, ROOM_HEIGHT / height))


def _isolines(scene: _Scene) -> NDArray[np.float64]:
    """Return the visible pieces (…, 2, 3) of some parameter lines."""
    pieces = []
    for mesh in (scene.mesh, np.swapaxes(scene.mesh, 0, 1)):
        lines = mesh[np.linspace(0, len(mesh) - 1, ISOLINES + 1).round().astype(int)]
        visible = scene.visible(lines.reshape(-1, 3)).reshape(lines.shape[:2])
        both = visible[:, 1:] & visible[:, :-1]
        pieces.append(np.stack([lines[:, :-1], lines[:, 1:]], axis=2)[both])
    return np.concatenate(pieces)


def _colours(K: NDArray[np.float64]) -> tuple[Normalize, Colormap, bool]:
    """Return the colour scale of curvatures, symmetric to zero, and whether some lie beyond it."""
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
    """Normals that are drawn alike: in a colour, as rings or as discs."""

    label: str
    normals: NDArray[np.float64]
    colour: str
    ring: bool


def _draw_sphere(figure: Figure, samples: Samples, normals: NDArray[np.float64]) -> None:
    from matplotlib.lines import Line2D

    index, missed = samples.normal_index, np.ones(len(normals), dtype=bool)
    missed[index] = False
    # One normal may have samples of both kinds: a disc with a ring round it.
    kinds = [
        _Kind("no sample", normals[missed], NO_SAMPLE, False),
        _Kind("elliptic", normals[index[samples.elliptic]], ELLIPTIC, True),
        _Kind("hyperbolic", normals[index[samples.hyperbolic]], HYPERBOLIC, False),
    ]
    axes = figure.add_axes(_box(RIGHT, MIDDLE, 2.6 * RADIUS, 2.6 * RADIUS))
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    view = _view_of(samples.normals if len(samples) else normals)
    _draw_globe(axes, view)
    area = _marker_area(normals)
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
        # What lies behind shines through the globe.
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
    whose = "their normals" if len(samples) else "the normals that were asked"
    _write(figure, RIGHT, TITLES, f"{whose}, on the unit sphere")


def _draw_globe(axes: Axes, view: NDArray[np.float64]) -> None:
    """Draw a translucent globe with meridians and parallels every 30°, and the three axes."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Circle
    from matplotlib.patheffects import withStroke

    axes.add_patch(Circle((0, 0), 1.0, facecolor=GLOBE, alpha=0.75, linewidth=0, zorder=2))
    turn = np.linspace(0.0, 2 * math.pi, 181)
    c, s, ones = np.cos(turn), np.sin(turn), np.ones_like(turn)
    circles = [
        np.outer(c, [math.cos(a), math.sin(a), 0.0]) + np.outer(s, [0.0, 0.0, 1.0])
        for a in np.radians(range(0, 180, 30))
    ] + [
        np.stack([math.cos(a) * c, math.cos(a) * s, math.sin(a) * ones], axis=1)
        for a in np.radians(range(-60, 90, 30))
    ]
    seen = np.array(circles) @ view.T
    pieces = np.stack([seen[:, :-1], seen[:, 1:]], axis=2).reshape(-1, 2, 3)
    front = pieces[(pieces[..., 2] >= 0.0).all(axis=1)][..., :2]
    axes.add_collection(LineCollection(list(front), colors="white", linewidths=0.8, zorder=3))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=PALE, linewidth=0.6, zorder=4))
    halo = [withStroke(linewidth=2.0, foreground="white")]
    for direction, name in zip(view.T, "xyz", strict=True):
        across = float(np.linalg.norm(direction[:2]))
        if direction[2] < -0.3:  # behind the globe
            continue
        reach = 1.1 / across if across > 0.75 else 1.15
        axes.plot(*np.outer(direction[:2], [1.0, reach]), color=INK, linewidth=0.7, zorder=5)
        x, y, _ = direction * (reach + 0.1)
        axes.text(x, y, name, ha="center", va="center", path_effects=halo, zorder=7)


def _view_of(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rows right, up, and towards a viewer who sees most of the normals.

    That is the viewer of the left half, turned towards the mean normal, the further the more the
    normals agree.
    """
    old = _view()
    mean = normals.mean(axis=0)
    new = (1.0 - np.linalg.norm(mean)) * old[2] + mean
    length = float(np.linalg.norm(new))
    cosine = float(old[2] @ new) / length if length > 1e-6 else -1.0
    if cosine < -0.999:  # straight from behind
        return old * [[-1.0], [1.0], [-1.0]]
    new /= length
    turned = old[:2] - np.outer(old[:2] @ new / (1.0 + cosine), old[2] + new)
    return np.vstack([turned, new])


def _marker_area(normals: NDArray[np.float64]) -> float:
    """Return the area of a marker in points², such that the normals have room on the sphere."""
    mean = normals.mean(axis=0)
    length = float(np.linalg.norm(mean))
    depth = 1.0 - float((normals @ mean).min()) / length if length > 1e-3 else 2.0
    room = 2 * math.pi * max(depth, 0.01) * (72 * RADIUS) ** 2
    return float(np.clip(0.12 * room / len(normals), 0.6, 8.0))
