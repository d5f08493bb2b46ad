"""What a sampling returns: points, normals, parameters, curvatures, and how it went."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .progress import busy
from .sample_arrays import SampleArrays
from .splines.spline import Spline, short_label
from .summary import kinds_of_points, summary_of
from .whole import Whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .cad.part import Part
    from .density.deviation import NormalDeviation
    from .meshes.mesh import Mesh
    from .surface.surface import Surface

__all__ = ["Samples"]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Samples(SampleArrays):
    """N samples of a surface, one row each; lengths in the unit L of the surface.

    `sample` and the other samplers make them. A boolean mask (N,), an index array or a slice
    picks rows, with the same report and spline: ``samples[samples.elliptic]``;
    `Samples.concatenate` joins several.

    With ``dtype=numpy.float32``, all numbers except the indices are float32. Fields that were not
    requested (`fields` of `sample`) are missing: reading them raises MissingFieldError, an
    AttributeError. All arrays are C-contiguous; one that is not is copied.

    With ``on="surface"`` (see `sample`), points, normals and curvatures are those of the surface at
    `uv`. A sample with a `normal_index` has the prescribed normal; that of the surface differs from
    it by rounding, 1e-12 where it is regular. With ``on="spline"``, and where `on_surface` is
    False, all of them are those of the spline.

    Attributes
    ----------
    points : (N, 3) float64 array
        Points of the surface, in L.
    normals : (N, 3) float64 array
        Unit normals at the points.
    uv : (N, 2) float64 array
        Parameters of the points.
    support : (N,) float64 array
        Support function h = n·x (4), in L.
    gaussian_curvature : (N,) float64 array
        Gaussian curvature K, in 1/L². Points are hyperbolic where its sign bit is set, −0.0
        included; those where it is zero up to rounding are `parabolic`, too. On surfaces smaller
        than 1e-154 it may be infinite, on those larger than 1e154 zero: float64 does not hold it.
    mean_curvature : (N,) float64 array
        Mean curvature H, in 1/L, positive for a sphere with outward normals.
    normal_index : (N,) int64 array
        Rows of the prescribed normals; −1 for a sample that fills a gap.
    patch_index : (N,) int64 array
        Patches of the spline in which the samples were found.
    on_surface : (N,) bool array or None
        Whether the sample is on the surface. False for one at a prescribed normal that could not be
        moved there from the spline: next to parabolic and singular points, and next to open borders
        where the surface has that normal outside of its domain only. None with ``on="spline"``, or
        if it was not requested.
    row, column : (N,) int64 array or None
        For samples on a grid (see ``density="aligned"`` of `sample`): the numbers of the lines
        v = const and u = const on which a sample is, from 0 upwards; −1 for one that is on no grid.
        None if no sample is, or if they were not requested.
    report : SamplingReport
        A report on the sampling.
    spline : Spline or None
        The spline that was sampled; None if it is unknown, as for samples from a file, and for
        samples of several pieces (see `Surface.pieces`), each of which has one.
    face_index, solid_index : (N,) int64 array or None
        Of a CAD part: the places of the sample's face and solid in `Part.faces` and `Part.solids`;
        −1 for a face that belongs to no solid. `uv` are those of the surface of the face. None for
        other samples.
    other_normals : (N, 3) float64 array or None
        Of samples with ``edges=True``: unit normals of the other face of a sample on a sharp edge,
        whose `normals`, `uv`, curvatures and `face_index` are those of the first; else NaN.
    other_uv : (N, 2) float64 array or None
        Of samples with ``edges=True``: parameters on the other face of a sharp edge; else NaN.
    other_face_index : (N,) int64 array or None
        Of samples with ``edges=True``: the other face of a sample on a sharp edge; −1 for others.
    surface : Surface, Part or None
        The surface, or the CAD part, on which the samples are; None with ``on="spline"``, for
        samples from a file, and after pickling if the surface does not pickle.
    offset_of : OffsetOf or None
        For samples of an `offset`: its distance, and the spline and the surface of the samples that
        were moved.

    Raises
    ------
    InputError
        If an array has another shape or dtype, or if there is none.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> samples
    Samples(200 points on torus: 125 dome-shaped, 75 saddle-shaped)
    >>> samples[samples.elliptic][:10]
    Samples(10 points on torus: 10 dome-shaped)
    >>> samples.points.shape, samples.normals.shape, samples.uv.shape
    ((200, 3), (200, 3), (200, 2))
    >>> K, H = samples.gaussian_curvature, samples.mean_curvature
    >>> bool((samples.principal_curvatures.sum(axis=1) - 2 * H).max() < 1e-12)
    True
    >>> bool((K[samples.hyperbolic] < 0).all())
    True
    >>> samples.fields
    ('points', 'normals', 'uv', 'support', ..., 'patch_index', 'on_surface')
    >>> bool(abs(samples.support).max() < 1.36), bool(samples.patch_index.max() < 1024)
    (True, True)
    >>> filling = samples.normal_index == -1
    >>> bool((samples.kind[filling] == "filling").all())
    True
    >>> samples.dtype, samples.spline, samples.report.samples
    (dtype('float64'), Spline(16 × 16 cells of torus), 200)
    >>> samples.on_surface.all(), samples.surface.name
    (np.True_, 'torus')
    >>> on_grid = gm.sample("torus", 200, density="aligned", cells=(16, 16))
    >>> bool((on_grid.row >= -1).all()), bool((on_grid.column >= -1).all())
    (True, True)
    >>> samples.face_index is samples.solid_index is None  # not of a CAD part
    True
    >>> samples.other_normals is samples.other_uv is samples.other_face_index is None
    True
    >>> samples.offset_of, samples.offset(0.1).offset_of.distance
    (None, 0.1)

    """

    def progressive(self, *, progress: bool = False) -> Samples:
        """Return the same samples in an order in which every prefix is well distributed.

        The first ones are far apart relative to the local spacing of the samples; the next ones
        halve the gaps, and so on. Spacings below a thousandth of the median count as that.

        Parameters
        ----------
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Returns
        -------
        Samples
            The samples in that order. Any prefix can be used: ``samples[:1000]``.

        Raises
        ------
        MissingFieldError
            Unless the samples have the fields points and normals.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", 200, cells=(16, 16))
        >>> few = samples.progressive()[:50]
        >>> few.coverage() < 1.2 * samples[:50].coverage()
        True

        """
        from .density.progressive import progressive_order

        points, normals = (x.astype(np.float64) for x in (self.points, self.normals))
        with busy("ordering samples", progress):
            return self[progressive_order(points, normals)]

    def summary(self) -> str:
        """Return one line: the number of samples, where they come from, what they cover.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("torus", normals=[[1, 0, 0], [0, 1, 1]], cells=(16, 16)).summary()
        '4 samples found by 2 normals (2 dome-shaped, 2 saddle-shaped)'

        """
        return summary_of(self)

    def offset(self, distance: float) -> Samples:
        """Return the samples moved along their normals: the offset surface x + d n.

        Points, support and curvatures are those of the offset, if the samples have them; normals,
        parameters and indices stay. `spline` and `surface` are None; `offset_of` has those of these
        samples, from which `mesh` and `weights` of the offset take the neighbours.

        Parameters
        ----------
        distance : float
            The distance d, in L. For d < 0 the offset lies inwards, if normals point outwards.

        Returns
        -------
        Samples
            One for each sample. Where a radius of curvature becomes 0, the offset is singular: K is
            infinite with its old sign, or NaN if it was 0, and H is NaN.

        Raises
        ------
        InputError
            Unless the distance is a finite number, and for curvatures whose squares their type does
            not hold (of surfaces smaller than 1e-154 or larger than 1e154).
        MissingFieldError
            If points lack their normals, or one of the curvatures the other one.

        Warns
        -----
        GaussmapWarning
            If the offset folds, because d passes a radius of curvature of that side: at how many
            samples (if they have curvatures), and the smallest radius. Normals stay there, too.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("sphere", normals=[[1, 0, 0]]).offset(0.5).points.round(3) + 0.0
        array([[1.5, 0. , 0. ]])

        """
        from .offset import offset

        return offset(self, distance)

    def write(self, path: str | os.PathLike[str], *, progress: bool = False) -> None:
        """Write the samples to a file; its suffix, in any case, chooses the format.

        An existing file is replaced once the new one is complete; if anything fails, it stays as it
        was. Files hold the fields that the samples hold, float32 as float32.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file. The suffix is one of

            - `.npz`: everything, the report included; reads back bit for bit.
            - `.ply`: binary, one vertex a sample, all columns and the report (in comments); reads
              back bit for bit. Indices are 32-bit. Needs the field `points`.
            - `.csv`: a header row and one row a sample; as many digits as it takes to read the same
              numbers again. With the extra "tables" Polars writes it, ten times as fast.
            - `.xyz`: rows `x y z nx ny nz`, digits as in `.csv`, no header. Needs `points` and
              `normals`.
            - `.vtp`: VTK PolyData with all arrays, and the report as field data; needs `points`.
            - `.parquet`, `.arrow`, `.feather`: the columns of `.csv` in binary, and the report and
              the units in the metadata of the schema; need the extra "tables" (PyArrow). Feather is
              the format of `.arrow`.
            - `.las`, `.laz`: points, with all other columns as extra dimensions, and the CRS of a
              `terrain`, whose `origin` is added again; coordinates are rounded to 1e-8 of the
              extent. Need `points`, and the extra "gis" (laspy).
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Raises
        ------
        UnknownNameError
            If the suffix is none of these.
        FileError
            If the file cannot be written.
        InputError
            If an index does not fit into a `.ply` file, or the format needs a missing field.
        MissingExtraError
            If a library that the format needs is not installed.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("torus", 200, cells=(16, 16)).write("torus.ply")
        >>> len(gm.read_samples("torus.ply"))
        200

        """
        from .files.formats import write_samples

        with busy("writing", progress):
            write_samples(self, path)

    def plot(
        self,
        surface: Surface | Spline | None = None,
        *,
        color: str | ArrayLike = "gaussian_curvature",
        view: Sequence[float] = (28.0, -55.0),
        axes: Axes | Sequence[Axes] | None = None,
        normals: ArrayLike | None = None,
    ) -> Figure:
        """Draw the samples on their surface, and the unit sphere with their normals.

        Parameters
        ----------
        surface : Surface, Spline or Part, optional
            What the samples are on, if they do not know it.
        color, view, axes, normals : optional
            As in `plot`: what the colours show, elevation and azimuth in degrees, axes of your own,
            the prescribed normals.

        Returns
        -------
        matplotlib.figure.Figure
            The figure, see `plot`.

        Raises
        ------
        MissingExtraError, MissingFieldError, UnknownNameError, InputError, SurfaceError
            As `plot`; InputError if the surface is not known.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", 200, cells=(16, 16))
        >>> samples.plot(color="support", view=(60, 0)).savefig("torus.png")

        """
        from .pictures.plot import plot_samples

        return plot_samples(self, surface, color=color, view=view, axes=axes, normals=normals)

    def view(
        self, path: str | os.PathLike[str], surface: Surface | Spline | Part | None = None
    ) -> None:
        """Write one page for browsers: the surface and the unit sphere, which light up together.

        Click a normal on the sphere, and its preimages light up on the surface; click a place on
        the surface, and the Gaussian image of the region around it lights up on the sphere. With
        the brush, or the shift key, drag to paint. The page holds all that it needs, 5 MB and more,
        and works without a network.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file, with the suffix `.html` or `.htm`. It is written whole or not at all.
        surface : Surface, Spline or Part, optional
            What the samples are on, if they do not know it.

        Raises
        ------
        MissingExtraError
            Without Plotly: ``pip install "gaussmap[view]"``.
        UnknownNameError
            If the suffix is none of these.
        FileError
            If the file cannot be written.
        MissingFieldError
            If the samples lack points, normals, Gaussian curvature or normal indices.
        InputError
            Without samples, for more than 50,000, and if the surface is not known.
        SurfaceError
            If the surface cannot be drawn.

        Notes
        -----
        A click next to the dot of a sample takes the normal of that sample; another one takes the
        direction that was clicked, or, if all samples are at prescribed normals, the nearest of
        these. The points that light up are

        - the samples with exactly this normal, up to the rounding of float32, if it is a prescribed
          one, or if several samples have it, as on planes. Made with ``normals=icosphere(…)``,
          samples are all points with that normal.
        - else one sample for each connected group of samples, of one sign of K, whose normals are
          within an angle of it: the nearest one in normal. That counts preimages correctly where
          samples are dense relative to the angle, which a slider changes, and not next to
          parabolic lines, where two preimages are about to meet.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("torus", 200, cells=(16, 16)).view("torus.html")

        """
        from .viewer.view import view

        view(self, path, surface)

    def mesh(
        self,
        spline: Spline | None = None,
        *,
        angle: float | None = None,
        prefer: Literal["shape", "normals"] = "shape",
        progress: bool = False,
    ) -> Mesh:
        """Return a triangle mesh of the whole surface through the samples.

        Neighbours are those of a Delaunay triangulation of the parameters: the mesh closes where
        the surface does, has one vertex at a pole, and reaches open borders by points that are
        added there, as far apart as the samples near them. Then edges are flipped. Samples that
        coincide become one vertex.

        Samples on a complete graded grid (`row` and `column`) need no Delaunay triangulation: each
        cell of the grid is cut along a diagonal, and samples between its lines are inserted. Points
        are added where its lines meet open borders. Samples of trimmed and of one-sided surfaces,
        parts of grids, and grids with more than 30 % of other samples are meshed as any others.

        Parameters
        ----------
        spline : Spline, optional
            The spline of the samples, if they do not know it; for an offset that of `offset_of`.
        angle : float, optional
            In degrees. Triangles that deviate from a normal at a corner by more are left out, for
            samples of a part of the surface only.
        prefer : {"shape", "normals"}, default "shape"
            - "shape": triangles are Delaunay on the surface, and have angles as large as the
              samples allow. A sample so close to others that a smallest angle stays below 5° is
              left out, and further ones until 95 % of the smallest angles are 25° at least. A grid
              keeps its samples, in long cells, too; for well-shaped triangles sample with
              ``density="isotropic"``.
            - "normals": triangles deviate from the normals at their corners as little as the
              samples allow. They are long and thin where the surface is curved in one direction
              only, and one sample is left out where a triangle would have no area.
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Returns
        -------
        Mesh
            The vertices, normals, parameters and triangles.

        Raises
        ------
        MissingFieldError
            Unless the samples have the fields points, normals and uv.
        InputError
            Without samples or spline, if a sample lies outside its domain, if `angle` leaves no
            triangle, and, without it, if there are too few samples for a mesh that closes.

        Notes
        -----
        Well-shaped triangles are the default because most programs that read a mesh need them:
        simulation, smoothing, simplification, discrete curvatures, and files of single precision,
        in which thin triangles lose their area. They cost accuracy: with the same number of
        vertices, distances and angles to the surface are larger by about a third than with
        "normals", see docs/meshes.md. That is the better choice for rendering, and for areas,
        volumes and other integrals: `weights` uses it.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", 200, cells=(16, 16))
        >>> samples.mesh()
        Mesh(200 vertices, 400 triangles on torus)
        >>> accurate = samples.mesh(prefer="normals")
        >>> bool(accurate.angles.mean() < samples.mesh().angles.mean())
        True

        """
        from .meshes.meshing import mesh_of

        if spline is None and self.offset_of is not None:
            spline = self.offset_of.spline
        with busy("meshing", progress):
            return mesh_of(self, self._spline_or(spline), angle, prefer)

    def coverage(
        self,
        spline: Spline | None = None,
        *,
        threads: int | None = None,
        progress: bool = False,
    ) -> float:
        """Return a bound of the distance from any point of the surface to the nearest sample, in L.

        Parameters
        ----------
        spline : Spline, optional
            The spline of the samples, if `spline` of the samples is None.
        threads : int, optional
            The number of threads; by default all cores.
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Returns
        -------
        float
            The bound, at most 10 % above the distance of a point that was found. For samples on the
            surface, twice the largest distance of the surface from its spline is added. Infinite if
            there are no samples.

        Raises
        ------
        MissingFieldError
            Unless the samples have the field points.
        InputError
            If there is no spline.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", coverage=0.3, cells=(16, 16))
        >>> samples.coverage() < 1.1 * 0.3
        True

        """
        from .density.of_samples import coverage_of

        with busy("measuring the coverage", progress):
            if isinstance(self.surface, Whole):
                return self.surface.coverage_of(self.points, threads)
            return coverage_of(self.points, self._spline_if_one(spline), self.surface, threads)

    def normal_deviation(
        self,
        spline: Spline | None = None,
        *,
        threads: int | None = None,
        progress: bool = False,
    ) -> NormalDeviation:
        """Return the largest angles between normals of the surface and those of the samples.

        Normals are compared at 16 places for each sample and at least 20,000, and at more of them
        where larger angles may be.

        Parameters
        ----------
        spline : Spline, optional
            The spline of the samples, if `spline` of the samples is None.
        threads : int, optional
            The number of threads; by default all cores.
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Returns
        -------
        NormalDeviation
            The largest angle, in degrees, between the normal of a point of the surface and that of
            the sample nearest in normal (`normal_space`), and of the sample nearest in space
            (`space`). Both are 180 without samples.

        Raises
        ------
        MissingFieldError
            Unless the samples have the fields points and normals.
        InputError
            If there is no spline.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", angle=20.0, cells=(16, 16))
        >>> samples.normal_deviation().normal_space <= 20.0
        True

        """
        from .density.of_samples import deviation_of

        with busy("comparing normals", progress):
            if isinstance(self.surface, Whole):
                return self.surface.deviation_of(self.points, self.normals, threads)
            one = self._spline_if_one(spline)
            return deviation_of(self.points, self.normals, one, self.surface, threads)

    def weights(self, *, angle: float | None = None, progress: bool = False) -> NDArray[np.float64]:
        """Return the area of the surface that each sample stands for.

        Σ w f(points) approximates the integral of f over the surface: its area for f = 1, the
        volume of a closed surface for f = support / 3, 2π times the Euler characteristic for f =
        gaussian_curvature. The error falls with the square of the distance between samples, that is
        as 1 / N; that of the area as 1 / N², down to that of the spline. The weights are taken from
        the mesh of the samples; its triangles are curved by the normals.

        Parameters
        ----------
        angle : float, optional
            In degrees, as in `mesh`.
        progress : bool, default False
            Show on a terminal what is done, from a second on.

        Returns
        -------
        (N,) float64 array
            Areas in L². Of samples that coincide, all but one have 0.

        Raises
        ------
        MissingFieldError, InputError
            As `mesh`.
        SurfaceError
            If float64 does not hold the areas, of surfaces larger than about 1e150 or smaller than
            1e-150.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", 500)
        >>> f"{samples.weights().sum():.1f}"  # 4π² · 0.35
        '13.8'

        """
        from .meshes.weights import area_weights

        with busy("computing weights", progress):
            if isinstance(self.surface, Whole):
                return self.surface.weights_of(self)
            return area_weights(self, angle)

    def __repr__(self) -> str:
        label = short_label(self.report.surface)
        return f"Samples({len(self):,} points on {label}{kinds_of_points(self)})"

    def _spline_if_one(self, spline: Spline | None) -> Spline | None:
        """Return what `_spline_or` returns, but None for samples on several pieces."""
        on_pieces = spline is None and self.spline is None and self.surface is not None
        return None if on_pieces else self._spline_or(spline)

    def _spline_or(self, spline: Spline | None) -> Spline:
        """Return the spline that is given, else that of the samples; InputError without one."""
        spline = self.spline if spline is None else spline
        if spline is None and isinstance(self.surface, Whole):
            raise InputError(
                "this is for samples of one surface, and these are of a CAD part; sample "
                "part.faces[0].surface, for example."
            )
        if spline is None:
            raise InputError(
                "these samples do not know the spline that was sampled (those from a file, of an "
                "offset and of several pieces do not); give it, as in "
                "samples.mesh(gm.fit(surface)), or sample each of surface.pieces()."
            )
        if not isinstance(spline, Spline):
            raise InputError(f"spline must be a Spline, not {type(spline).__name__}.")
        return spline
