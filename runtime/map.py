"""`GaussMap`: the points of one surface at given normals, for repeated queries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .density.on_pieces import geometries_of
from .map_methods import Methods
from .sample import unwarned
from .samples.request import checked_request
from .samples.samples import Samples
from .samples.whole import Whole
from .spline.spline import Spline
from .surface.surface import Surface
from .surface.surfaces import named

__all__ = ["GaussMap"]


class GaussMap(Methods):
    """The inverse Gauss map of a surface: all points with given normals, for repeated queries.

    The surface is fitted and indexed when the map is made. After that a query of one normal takes a
    fraction of a millisecond. Results do not depend on earlier queries, nor on the number of
    threads; several threads may query one map at once, and maps can be pickled. `sample` with
    `normals` gives the same samples, and caches the maps of the last eight surfaces.

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
        surface: Surface | Spline | Whole | str,
        *,
        cells: Sequence[int] | None = None,
        on: str | None = None,
    ) -> None:
        self._surface, self._cells, self._on = named(surface), cells, on
        self._geometries = None
        if not isinstance(self._surface, Whole):
            self._geometries = geometries_of(self._surface, cells, on, indexed=True)

    @property
    def surface(self) -> Surface | Spline | Whole:
        """The surface, spline or part."""
        return self._surface

    @property
    def spline(self) -> Spline | None:
        """The spline of the surface, None for parts and several pieces.

        It is an argument for `silhouette`, `SupportFunction.of_spline` and
        `gauss_map.GaussianImages`.
        """
        known = self._geometries or ()
        return known[0].spline if len(known) == 1 else None

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
            The same as ``sample(surface, normals=normals)``, which warns if there are none.

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
        return self._found(normals, fields, dtype, threads, progress, out)[0]

    def count(self, normals: ArrayLike, *, threads: int | None = None) -> NDArray[np.int64]:
        """Return the number of points with each of the normals.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.
        threads : int, optional
            The number of threads, by default one for each core.

        Returns
        -------
        (S,) int64 array
            The numbers of points.

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
        found, asked = self._found(normals, ("normal_index",), threads=threads)
        return np.bincount(found.normal_index, minlength=len(asked))

    def degree(self, normals: ArrayLike, *, threads: int | None = None) -> NDArray[np.int64]:
        """Return Σ sign K over the points with each of the normals.

        On a closed surface it is χ/2 for every normal, χ being the Euler characteristic.

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
        fields = ("normal_index", "gaussian_curvature")
        found, asked = self._found(normals, fields, threads=threads)
        signs = np.copysign(1.0, found.gaussian_curvature)
        return np.bincount(found.normal_index, signs, minlength=len(asked)).astype(np.int64)

    def _found(
        self,
        normals: ArrayLike,
        fields: Sequence[str] | None,
        dtype: DTypeLike = np.float64,
        threads: int | None = None,
        progress: bool = False,
        out: Samples | None = None,
    ) -> tuple[Samples, NDArray[np.float64]]:
        """Return the points with given normals, and the normals as unit vectors."""
        return unwarned(
            self.surface,
            checked_request(normals, None, None, None, None, threads),
            cells=self._cells,
            on=self._on,
            fields=fields,
            dtype=dtype,
            threads=threads,
            progress=progress,
            out=out,
            geometries=self._geometries,
        )
