"""`GaussMap`: the points of one surface at given normals, for repeated queries."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .base.checks import pair_of_cells
from .base.errors import InputError, in_memory, shown
from .base.threads import thread_count
from .directions.regions import Reach
from .directions.unit import as_normals
from .map_methods import Methods
from .onto_surface.at_creases import Creases
from .onto_surface.at_tips import samples_at, with_creases
from .onto_surface.on_spline import OnPatches
from .onto_surface.on_surface import checked_place
from .onto_surface.proved import ProvedSurface
from .onto_surface.reach import in_reach
from .onto_surface.smooth_pieces import proved_or_fitted, samples_of_pieces
from .onto_surface.tip_degrees import tip_degrees
from .samples.fields import Component, checked_dtype, checked_fields
from .samples.samples import Samples
from .samples.whole import Whole
from .spline.nets import AnySpline
from .surface.surface import Surface
from .surface.surfaces import named

# The number of surfaces whose maps are cached; splines and indices take some MB each.
KEPT = 8
# The fields that the comparison of samples with points of creases needs.
OF_CREASES = ("points", "uv", "uv_radius", "normal_index", "component")


class GaussMap(Methods):
    """The inverse Gauss map of a surface: all points with given normals, for repeated queries.

    The surface is indexed when the map is made. It is fitted with ``on="spline"``, if its points
    cannot be proved, or when its spline is read. After that a query of one normal takes a fraction
    of a millisecond. Results do not depend on earlier queries, nor on the number of threads;
    several threads may query one map at once, and maps can be pickled. `sample` with `normals`
    gives the same samples, and caches the maps of the last eight surfaces.

    Parameters
    ----------
    surface : Surface, Spline, Part or str
        The surface, or its name in the catalogue. Its function must return the same points each
        time.
    cells : (int, int), optional
        The numbers of cells of the spline along u and v, see `fit`.
    on : {"surface", "spline"}, optional
        The surface on which the points lie, see `sample`.

    Raises
    ------
    InputError, UnknownNameError, SurfaceError
        As `sample`.

    See Also
    --------
    sample : samples at normals in one call, and samples that fill gaps.

    Examples
    --------
    >>> import gaussmap as gm
    >>> torus = gm.GaussMap("torus")
    >>> torus
    GaussMap(torus)
    >>> samples = torus.points([[0, 0.6, 0.8]])
    >>> samples.points.shape, samples.normals.shape
    ((2, 3), (2, 3))
    >>> torus.surface.name, torus.spline
    ('torus', Spline(64 × 64 cells of torus))
    >>> gm.silhouette(torus.spline, (1, 2, 3), count=100).points.shape
    (100, 3)

    """

    def __init__(
        self,
        surface: Surface | AnySpline | Whole | str,
        *,
        cells: Sequence[int] | None = None,
        on: str | None = None,
    ) -> None:
        self._surface = named(surface)
        self._pieces: tuple[OnPatches | ProvedSurface, ...] = ()
        if isinstance(self._surface, Whole):
            check_part(cells, on)
        else:
            self._pieces = proved_or_fitted(self._surface, cells, on)
        self._creases: Creases | None = None
        proved = all(isinstance(x, ProvedSurface) for x in self._pieces)
        if proved and isinstance(self._surface, Surface):
            self._creases = Creases.of(self._surface)

    @property
    def surface(self) -> Surface | AnySpline | Whole:
        """The surface, spline or part."""
        return self._surface

    @property
    def spline(self) -> AnySpline | None:
        """The spline of the surface, None for parts and several pieces.

        It is an argument for `silhouette`, `SupportFunction.of_spline` and
        `gauss_map.GaussianImages`.
        """
        return self._pieces[0].spline if len(self._pieces) == 1 else None

    @property
    def _fitted(self) -> tuple[OnPatches, ...]:
        """The pieces with their splines; the computation of densities needs the splines."""
        return tuple(x.fitted for x in self._pieces)

    def _with_fit(self, samples: Samples, reach: Reach | None = None) -> Samples:
        """Return samples with their spline, and with a report that describes this spline.

        With a `reach`, both refer to the part of the surface that is in reach.
        """
        if len(self._pieces) != 1:
            return samples
        return self._pieces[0].within(reach).with_fit(samples)

    def __repr__(self) -> str:
        return f"GaussMap({getattr(self.surface, 'name', self.surface)})"

    def points(
        self,
        normals: ArrayLike,
        *,
        fields: Sequence[str] | None = None,
        dtype: DTypeLike = np.float64,
        threads: int | None = None,
        progress: bool = False,
        out: Samples | None = None,
    ) -> Samples:
        """Return every point whose normal is one of `normals`, each exactly once.

        A tip counts as a point with each of the normals in its normal cone. A curve of points with
        the same normal has one sample, see `Component`.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.
        fields : sequence of str, optional
            The arrays of `Samples` that are computed and stored; all by default.
        dtype : dtype_like, default numpy.float64
            With numpy.float32, all numbers but the indices are rounded when they are stored.
        threads : int, optional
            The number of threads, by default one for each core.
        progress : bool, default False
            Show progress on a terminal.
        out : Samples, optional
            For a map of one spline: samples of an earlier call that are no longer needed. Their
            memory is reused if it suffices, which is faster for millions of samples. Afterwards the
            contents of `out`, and of other samples that share its arrays, are undefined.

        Returns
        -------
        Samples
            The same as ``sample(surface, normals=normals)``, which warns if there are none. Where
            points are proved, no spline is needed, and the entries of the report on it are None.

        Raises
        ------
        InputError, UnknownNameError
            As `sample`; also for `out` if the map is that of a surface or a part.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.GaussMap("torus").points([[1, 0, 0], [0, 0.6, 0.8]])
        >>> sorted(samples.normal_index.tolist())
        [0, 0, 1, 1]
        >>> on_spline = gm.GaussMap("torus", on="spline")
        >>> samples = on_spline.points(gm.icosphere(20))
        >>> again = on_spline.points(-gm.icosphere(20), out=samples)
        >>> again.points.base is samples.points
        True

        """
        thread_count(threads)
        directions = as_normals(normals, threads=threads)
        return self._points(directions, fields, dtype, threads, progress, out)

    def count(self, normals: ArrayLike, *, threads: int | None = None) -> NDArray[np.int64]:
        """Return the number of points, or curves of points, with each of the normals.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.
        threads : int, optional
            The number of threads, by default one for each core.

        Returns
        -------
        (S,) int64 array
            The numbers of components, see `Component`.

        Raises
        ------
        InputError
            For unusable normals.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.GaussMap("torus").count([[1, 0, 0], [0, 0.6, 0.8]])
        array([2, 2])

        """
        found = self.points(normals, fields=("normal_index",), threads=threads)
        return np.bincount(found.normal_index, minlength=found.report.normals or 0)

    def degree(self, normals: ArrayLike, *, threads: int | None = None) -> NDArray[np.int64]:
        """Return Σ sign K over the points with each of the normals.

        On a closed surface it is χ/2 for every normal, χ being the Euler characteristic; on a
        one-sided surface, such as a Klein bottle, the degrees of n and −n add up to χ. If the
        surface ends in tips, their degrees are added: 1 for normals in the normal cone of a convex
        tip, and in general the signed number of times that the normals at the tip cover a normal.
        Isolated points with K = 0, curves and points of creases count with their index, and
        undecided boxes with their degree. A curve counts 0 if its index is unknown, as where it
        ends in an edge or in a crease, or branches.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.
        threads : int, optional
            The number of threads, by default one for each core.

        Returns
        -------
        (S,) int64 array
            The sums of signs.

        Raises
        ------
        InputError
            For unusable normals.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.GaussMap("torus").degree([[1, 0, 0], [0, 0.6, 0.8]])
        array([0, 0])

        """
        fields = ["points", "normal_index", "gaussian_curvature", "component"]
        if self._creases is not None:
            fields.append("uv_radius")
        directions = as_normals(normals)
        found = self.points(directions, fields=fields, threads=threads)
        asked, signs = found.report.normals or 0, np.copysign(1.0, found.gaussian_curvature)
        kinds = found.component
        assert kinds is not None
        whole = self._surface
        counted = kinds == Component.REGULAR
        if isinstance(whole, Whole):  # on its creases, K has the sign of the index
            counted |= kinds == Component.CREASE
        signs[~counted] = 0.0
        sums = np.bincount(found.normal_index, signs, minlength=asked).astype(np.int64)
        known = np.isin(kinds, (Component.ISOLATED, Component.CURVE, Component.TIP))
        which = np.unique(found.normal_index[known])
        for face in whole._space(threads).pieces if isinstance(whole, Whole) else ():
            sums[which] += face.component_degrees(directions[which])
        for piece in self._pieces:
            sums += tip_degrees(piece, directions)
            sums[which] += piece.component_degrees(directions[which])
        if self._creases is not None:
            at = self._creases.besides(found, directions)
            sums += np.bincount(at.numbers, np.nan_to_num(at.degrees), asked).astype(np.int64)
        for place in found.report.undecided or ():
            sums[place.normal] += place.degree or 0
        return sums

    @in_memory
    def _points(
        self,
        normals: NDArray[np.float64],
        fields: Sequence[str] | None,
        dtype: DTypeLike = np.float64,
        threads: int | None = None,
        progress: bool = False,
        out: Samples | None = None,
        reach: Reach | None = None,
    ) -> Samples:
        """Return the points with unit normals (S, 3); with a `reach`, only at normals in it."""
        if not isinstance(out, Samples | None):
            raise InputError(f"out must be Samples of an earlier call, not {shown(out)}.")
        number, surface = checked_dtype(dtype), self._surface
        if out is not None and (len(self._pieces) != 1 or self._pieces[0].on == "surface"):
            raise InputError(
                "out=... holds samples of one spline; those of a surface or part need new memory: "
                'leave it out, or make the map with on="spline".'
            )
        if isinstance(surface, Whole):
            wanted = checked_fields(fields, True, True, part=True)
            return surface._samples_at(normals, wanted, number, threads, progress)
        on_surface = self._pieces[0].on == "surface"
        proved = all(isinstance(x, ProvedSurface) for x in self._pieces)
        wanted = checked_fields(fields, on_surface, proved, given=True)
        memory = {} if out is None else out.arrays()
        # Points of creases are compared with other points in double precision.
        more = wanted if self._creases is None else [*dict.fromkeys([*wanted, *OF_CREASES])]
        given = number if self._creases is None else np.dtype(np.float64)
        pieces = [x.used(given, threads, memory).within(reach) for x in self._pieces]
        if len(pieces) == 1:
            found = samples_at(pieces[0], normals, more, given, progress)
        else:
            assert isinstance(surface, Surface)
            known = in_reach(surface, reach) if on_surface else None
            found = samples_of_pieces(surface.name, known, pieces, normals, more, given, progress)
        if self._creases is None:
            return found
        return with_creases(found, self._creases, normals, wanted, number, reach)


def check_part(cells: Sequence[int] | None, on: str | None) -> None:
    """Raise InputError if `cells` or on="spline" is given for a part: parts have no spline."""
    if cells is not None:
        raise InputError("cells are for splines; the faces of a part need none.")
    if checked_place(on) == "spline":
        raise InputError("samples on a spline are of surfaces; those of a part lie on its faces.")


def kept_map(
    surface: Surface | AnySpline, cells: Sequence[int] | None = None, on: str | None = None
) -> GaussMap:
    """Return the map of a surface, cached for the last few surfaces."""
    if not isinstance(surface, Surface | AnySpline):
        return GaussMap(surface, cells=cells, on=on)  # raises
    return _kept(surface, None if cells is None else pair_of_cells(cells), on)


@lru_cache(KEPT)
def _kept(surface: Surface | AnySpline, cells: tuple[int, int] | None, on: str | None) -> GaussMap:
    return GaussMap(surface, cells=cells, on=on)
