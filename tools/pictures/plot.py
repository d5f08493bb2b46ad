"""One picture of a sampling: normals on the unit sphere, the support function, the samples."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import finite_array, listed, real_values, yes_or_no
from ...runtime.base.errors import InputError, printable
from ...runtime.base.extras import check_extra
from ...runtime.directions.unit import as_normals
from ...runtime.samples.samples import Samples
from ...runtime.spline.nets import AnySpline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..cad.part import Part
from ..density.request import checked_request
from ..files import paths
from ..sampling.sample import sample_and_normals
from .colours import CURVATURE, checked_values, colours_of, draw_scale
from .marked import Marked, marked
from .palette import PALE, STYLE
from .scene import VIEW, Scene, scene_of_samples
from .scene import view as rows_of_view
from .sphere_half import RADIUS, draw_sphere, view_of
from .support_globes import ROOM as BRANCH_ROOM
from .support_globes import Branch, branches_of, draw_branch
from .surface_half import View, draw_face_numbers, draw_surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COUNT = 2_000  # the default number of samples
DOTS_PER_INCH = 200
LONGEST_LINE = 140  # characters of the summary
# In inches: the width and height of the figure, and the heights at which the middle of the panels,
# titles and legends are.
WIDTH, HEIGHT, MIDDLE, TITLES, LEGENDS = 9.0, 4.6, 2.28, 3.8, 0.48
# The centres of the panels along x, in inches: the sphere, the support function, the surface.
SPHERE, SUPPORT, SURFACE = 1.4, 3.6, 6.5
WIDE_SPHERE, WIDE_SURFACE = 1.7, 6.0
ROOM, WIDE_ROOM = (3.7, 2.75), (4.7, 2.75)  # of the surface
GLOBE = 0.64  # the radius of a globe of the support function
SUFFIXES = (".png", ".pdf", ".svg")
FINE = 300  # dots per inch of rasterized quadrangles in .pdf and .svg files
UNDATED = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def plot(
    surface: Surface | AnySpline | Part | str,
    samples: Samples | None = None,
    *,
    color: str | ArrayLike = CURVATURE,
    view: Sequence[float] = VIEW,
    axes: Axes | Sequence[Axes] | None = None,
    normals: ArrayLike | None = None,
    face_numbers: bool = False,
) -> Figure:
    """Draw a surface or CAD part with samples, and the unit sphere with their normals.

    On the left is the unit sphere with the normals, seen from the same direction as the surface, or
    turned towards their mean if they are concentrated. On the right are the visible samples in
    colour; those that fill gaps are smaller, and their normals have another colour. One prescribed
    normal and its samples are marked. In the middle is the support function at the prescribed
    normals, if it has at most two branches: one for K > 0 and one for K < 0. If a surface is very
    flat or very high, its heights are rescaled, and the label of the axis gives the factor.

    Parameters
    ----------
    surface : Surface, Spline, Part or str
        The surface to draw, as in `sample`.
    samples : Samples, optional
        Samples of the surface; by default those at `normals`, or 2,000.
    color : str or (N,) array_like, default "gaussian_curvature"
        The colours of the samples: the name of a column, as in tables ("support", "z", "nx",
        "mean_curvature", "face_index" …), or a number for each sample.
    view : (float, float), default (28, -55)
        Elevation and azimuth of the viewer, in degrees.
    axes : Axes3D, or (Axes3D, Axes), optional
        Existing axes to draw into: the surface only, or the surface and the sphere. They get no
        title, legend or scale of colours. Samples and lines hidden in `view` are left out.
    normals : (S, 3) array_like, optional
        The prescribed normals of the samples: those without a sample are drawn in grey.
    face_numbers : bool, default False
        Write the number in the file on each face of a CAD part that has a visible sample.

    Returns
    -------
    matplotlib.figure.Figure
        The figure. Notebooks display it; ``figure.savefig("torus.png")`` writes it. Pyplot does not
        manage it.

    Raises
    ------
    MissingExtraError
        Without Matplotlib: ``pip install "gaussmap[plot]"``.
    MissingFieldError
        If the samples lack points, normals, Gaussian curvature or normal indices.
    UnknownNameError
        For an unknown column.
    InputError
        For other invalid arguments.
    SurfaceError
        If the surface cannot be evaluated.

    See Also
    --------
    Samples.plot : the same, for samples that hold their surface.

    Examples
    --------
    >>> import gaussmap as gm
    >>> torus = gm.fit(gm.surfaces.torus(), cells=(16, 16))
    >>> figure = gm.plot(torus, gm.sample(torus, 200), color="mean_curvature", view=(60, 0))
    >>> figure.savefig("torus.png")

    """
    check_extra("matplotlib", "plot", "a picture")
    if not isinstance(surface, AnySpline | Part):
        surface = named(surface)
    if samples is None:
        count = COUNT if normals is None else None
        request = checked_request(normals, count, None, None, None, None)
        samples, normals = sample_and_normals(
            surface, request, cells=None, threads=None, progress=False
        )
    return plot_samples(
        samples, surface, color=color, view=view, axes=axes, normals=normals,
        face_numbers=face_numbers,
    )  # fmt: skip


def plot_part(
    self: Part,
    samples: Samples | None = None,
    *,
    color: str | ArrayLike = CURVATURE,
    view: Sequence[float] = VIEW,
    axes: Axes | Sequence[Axes] | None = None,
    normals: ArrayLike | None = None,
    face_numbers: bool = False,
) -> Figure:
    """Draw the part with samples, and the unit sphere with their normals: `Part.plot`.

    Parameters
    ----------
    samples : Samples, optional
        Samples of the part; by default those at `normals`, or 2,000.
    color, view, axes, normals, face_numbers : optional
        As in `plot`: the column or array shown in colour, elevation and azimuth in degrees, axes to
        draw into, the prescribed normals, whether faces have their numbers.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, see `plot`.

    Raises
    ------
    MissingExtraError, MissingFieldError, UnknownNameError, InputError, SurfaceError
        As `plot`.

    Examples
    --------
    >>> from gaussmap.tools.cad.examples import box
    >>> box().plot(face_numbers=True, view=(60, 0)).savefig("box.png")

    """
    return plot(
        self, samples, color=color, view=view, axes=axes, normals=normals,
        face_numbers=face_numbers,
    )  # fmt: skip


def plot_samples(
    self: Samples,
    surface: Surface | AnySpline | Part | None = None,
    *,
    color: str | ArrayLike = CURVATURE,
    view: Sequence[float] = VIEW,
    axes: Axes | Sequence[Axes] | None = None,
    normals: ArrayLike | None = None,
    face_numbers: bool = False,
) -> Figure:
    """Draw the samples on their surface, and the unit sphere with their normals.

    Sums of `convolve` are drawn on their mesh; without a mesh, all of them are visible.

    Parameters
    ----------
    surface : Surface, Spline or Part, optional
        The surface of the samples, if they do not hold it.
    color, view, axes, normals, face_numbers : optional
        As in `plot`: the column or array shown in colour, elevation and azimuth in degrees, axes to
        draw into, the prescribed normals, whether faces have their numbers.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, see `plot`.

    Raises
    ------
    MissingExtraError, MissingFieldError, UnknownNameError, InputError, SurfaceError
        As `plot`; InputError if the surface is unknown.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> samples.plot(color="support", view=(60, 0)).savefig("torus.png")

    """
    check_extra("matplotlib", "plot", "a picture")
    elevation, azimuth = finite_array(view, (2,), "view").tolist()
    panels = _checked_axes(axes)
    directions = _checked_normals(self, () if normals is None else normals)
    checked_values(self, color)
    if yes_or_no(face_numbers, "face_numbers") and self.face_index is None:
        raise InputError("only the faces of a CAD part have numbers, and samples of these.")
    scene = scene_of_samples(self, surface, rows_of_view(elevation, azimuth))
    return _drawn(self, scene, directions, color, (elevation, azimuth), panels, face_numbers)


def _checked_normals(samples: Samples, normals: ArrayLike) -> NDArray[np.float64]:
    """Return the prescribed normals as unit vectors (S, 3), or an empty array without any.

    Raises InputError if there are too few of them for the samples.
    """
    if not isinstance(samples, Samples):
        raise InputError(f"samples must be Samples, not {type(samples).__name__}.")
    none = real_values(normals, "normals").size == 0
    if none and len(samples):
        return np.empty((0, 3))
    if none:
        raise InputError("there are no samples to draw, and no normals.")
    directions = as_normals(normals)
    if len(samples) and int(samples.normal_index.max()) >= len(directions):
        raise InputError("the samples do not belong to these normals: there are too few normals.")
    return directions


def _checked_axes(axes: Axes | Sequence[Axes] | None) -> tuple[Any, ...]:
    """Return a tuple of the given axes: none, one for the surface, or also one for the sphere."""
    if axes is None:
        return ()
    from matplotlib.axes import Axes as AnyAxes
    from mpl_toolkits.mplot3d import Axes3D

    panels = [axes] if isinstance(axes, AnyAxes) else listed(axes) or []
    flat = all(isinstance(x, AnyAxes) and not isinstance(x, Axes3D) for x in panels[1:])
    if len(panels) not in (1, 2) or not isinstance(panels[0], Axes3D) or not flat:
        raise InputError(
            'axes must be three-dimensional axes, made with projection="3d", or a pair of these '
            "and of ordinary ones for the sphere."
        )
    return tuple(panels)


def _drawn(
    samples: Samples,
    scene: Scene,
    normals: NDArray[np.float64],
    color: str | ArrayLike,
    view: View,
    axes: Sequence[Any],
    face_numbers: bool,
) -> Figure:
    """Draw samples on a scene, and prescribed normals, into `axes` or, if empty, a new figure."""
    visible = scene.visible(samples.points.astype(np.float64))
    with style():
        colours = colours_of(samples, color)
        if axes:
            draw_surface(axes[0], samples, scene, colours, view, visible)
            if face_numbers:
                draw_face_numbers(axes[0], samples, visible)
            for sphere in axes[1:]:
                draw_sphere(sphere, samples, normals, scene.view)
            return axes[0].figure
        from .figure import Picture

        figure = Picture(figsize=(WIDTH, HEIGHT), dpi=DOTS_PER_INCH)
        _write_titles(figure, samples)
        mark, branches = marked(samples, visible, scene.view), branches_of(samples)
        sphere, surface, room = SPHERE, SURFACE, ROOM
        if not branches:
            sphere, surface, room = WIDE_SPHERE, WIDE_SURFACE, WIDE_ROOM
        right: Any = figure.add_axes(_box(surface, MIDDLE, 5.0, 5.0), projection="3d")
        draw_surface(right, samples, scene, colours, view, visible, mark, room)
        if face_numbers:
            draw_face_numbers(right, samples, visible)
        left = figure.add_axes(_box(sphere, MIDDLE, 2.6 * RADIUS, 2.6 * RADIUS))
        handles = draw_sphere(left, samples, normals, scene.view, mark)
        if branches:
            _draw_support(figure, samples, branches, scene, mark)
        title = "no samples"
        if len(samples):
            draw_scale(figure.add_axes(_box(surface, LEGENDS + 0.06, 2.7, 0.1)), colours)
            shown = int(np.count_nonzero(visible))
            title = "points $x = \\nabla h(n)$" if branches else "points"
            title += f": {shown:,} of {len(samples):,} samples visible"
        _write(figure, sphere, TITLES, "normals $n$ on the unit sphere", parse_math=True)
        _write(figure, surface, TITLES, title, parse_math=True)
        figure.legend(
            handles=handles, loc="center", bbox_to_anchor=(sphere / WIDTH, LEGENDS / HEIGHT),
            frameon=False, handletextpad=0.1, labelspacing=0.5 if len(handles) < 4 else 0.2,
        )  # fmt: skip
    return figure


def _draw_support(
    figure: Figure, samples: Samples, branches: list[Branch], scene: Scene, mark: Marked | None
) -> None:
    """Draw the branches of the support function, one above the other, and their scale."""
    colours = colours_of(samples, "support")
    view = view_of(samples.normals, scene.view)
    for k, branch in enumerate(branches):
        height = MIDDLE + GLOBE * BRANCH_ROOM * (len(branches) - 1 - 2 * k)
        axes = figure.add_axes(_box(SUPPORT, height, *2 * [2 * BRANCH_ROOM * GLOBE]))
        draw_branch(axes, samples, branch, colours, view, mark)
    draw_scale(figure.add_axes(_box(SUPPORT, LEGENDS + 0.06, 1.4, 0.1)), colours)
    _write(figure, SUPPORT, TITLES, "support function $h(n)$", parse_math=True)


@contextmanager
def style() -> Iterator[None]:
    """Draw with matplotlib's defaults, so that a picture does not depend on the user's settings."""
    import matplotlib.style

    with (
        matplotlib.style.context(["default", STYLE]),
        warnings.catch_warnings(),
        np.errstate(all="ignore"),
    ):
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # in the name of a surface
        yield


def _write_titles(figure: Figure, samples: Samples) -> None:
    """Write the name of the surface and the summary of the samples."""
    name = " ".join(samples.report.surface.split())
    _write(
        figure, WIDTH / 2, HEIGHT - 0.26, name if len(name) <= 80 else name[:79] + "…", fontsize=11
    )
    lines = textwrap.wrap(samples.summary(), LONGEST_LINE)
    for k, line in enumerate(lines):
        place = HEIGHT - 0.47 + 0.03 * (len(lines) - 1) - 0.12 * k
        _write(figure, WIDTH / 2, place, line, fontsize=7.5, color=PALE)


def _write(figure: Figure, x: float, y: float, text: str, **looks: Any) -> None:  # noqa: ANN401
    """Write a text, centred at a position in inches; its dollar signs are not mathematics."""
    figure.text(
        x / WIDTH, y / HEIGHT, printable(text), ha="center", **{"parse_math": False, **looks}
    )


def _box(x: float, y: float, width: float, height: float) -> tuple[float, float, float, float]:
    """Return a rectangle (left, bottom, width, height) in fractions of the figure.

    It is given by its centre and its size in inches.
    """
    return (x - width / 2) / WIDTH, (y - height / 2) / HEIGHT, width / WIDTH, height / HEIGHT


def write_figure(figure: Figure, path: paths.PathLike) -> None:
    """Write a figure to a .png, .pdf or .svg file without a date: equal figures give equal files.

    Raises the errors of `check_target`, and FileError if the file cannot be written.
    """
    check_target(path)
    suffix = Path(path).suffix.lower()
    with style(), paths.atomic_path(path) as temporary, paths.written_by_library(path):
        # In .pdf and .svg files, quadrangles are rasterized with FINE dots per inch.
        dots = figure.dpi if suffix == ".png" else FINE
        figure.savefig(temporary, format=suffix[1:], metadata=UNDATED[suffix], dpi=dots)


def check_target(path: paths.PathLike) -> None:
    """Raise now the errors that writing would raise later: for its path, or without Matplotlib."""
    paths.check_target(path, SUFFIXES)
    check_extra("matplotlib", "plot", "a picture")
