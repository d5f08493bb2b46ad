"""`Surface`: a function x(u,v) over a rectangle of parameters, with boundary conditions."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.checks import text, with_gaps
from ..base.errors import InputError
from ..base.georeference import Georeference
from ..domain.domain import Assumed, Boundary, Domain, Periodic, checked_boundary, checked_domain
from ..domain.trim import Trim, trimmed_by
from ..spline.quasi_interpolant import fit_grid
from .derivatives import Evaluation
from .moved import IDENTITY, AffineMap, Moved, affine_map, moved_grid
from .surface_values import SurfaceValues
from .traced import traced_condition

if TYPE_CHECKING:
    import sympy

# How often each default name was used.
_used: Counter[str] = Counter()
_lock = threading.Lock()


@dataclass(frozen=True, eq=False, repr=False)
class Surface(SurfaceValues):
    """A parametric surface x(u,v).

    Make one with `from_callable`, `from_sympy`, `from_nurbs` or `from_grid`, or take one of
    `gaussmap.surfaces`. Normals point along x_u × x_v. A surface pickles if its callables do;
    those of the library do.

    Attributes
    ----------
    name : str
        Label of the surface.
    function : callable
        ``function(u, v)`` gets two float64 arrays of one shape and returns points of that shape +
        (3,).
    domain : ((u0, u1), (v0, v1)) of float
        The rectangle of the parameters.
    boundary : pair of pairs of str
        For u and for v, the boundary conditions at the lower and the upper bound: "open" (an edge),
        "periodic", "mirrored" (periodic with the other parameter reversed, as on the Möbius band:
        normals are opposite on both sides of the seam, and `Part` refuses it) or "pole" (the side
        is collapsed to a point, and each meridian continues along the opposite one). The spline may
        have poles in place of open sides, see `assumed_open`.
    grid : (m, n, 3) float64 array or None
        The points of a surface that was given by points; NaN where they are missing.
    derivative_function : callable or None
        The `derivatives` that were passed to `from_callable`.
    trim : Trim or None
        The part of the domain that belongs to the surface, None for all of it; see `trimmed`.
    assumed_open : (bool, bool)
        For u and for v, whether open sides were assumed (``periodic=False``) and not declared
        ("open"). Then `fit` tests whether a side is collapsed to a point at which the surface is
        smooth. Such a side becomes a pole, and the other parameter becomes periodic. A surface of
        points is tested when it is made: `boundary` contains its poles, and `grid` does not repeat
        the first points at the end of a periodic parameter.
    georeference : Georeference or None
        For a `terrain`: the coordinate reference system `crs`, as "EPSG:number" or WKT, the
        `origin` (x, y, z) that was subtracted from coordinates, and the `unit` of lengths.

    Examples
    --------
    >>> import gaussmap as gm
    >>> torus = gm.surfaces.torus(major=1.0, minor=0.35)
    >>> torus
    Surface(torus: u 0 to 6.28319 periodic, v 0 to 6.28319 periodic)
    >>> torus.name, torus.boundary, torus.grid, torus.derivative_function, torus.trim
    ('torus', (('periodic', 'periodic'), ('periodic', 'periodic')), None, None, None)
    >>> torus.georeference is None
    True
    >>> double = gm.Surface.from_callable(
    ...     lambda u, v: 2 * torus.function(u, v), torus.domain, periodic=(True, True)
    ... )
    >>> double.evaluate(0.0, 0.0)
    array([2.7, 0. , 0. ])
    >>> disk = gm.Surface.from_sympy(
    ...     ("r*cos(phi)", "r*sin(phi)", "r**2 / 4"), ("r", "phi"), ((0, 1), (0, "2*pi"))
    ... )
    >>> disk.assumed_open, disk.boundary[0], gm.fit(disk, (8, 24)).boundary[0]
    ((True, True), ('open', 'open'), ('pole', 'open'))

    """

    @classmethod
    def from_callable(
        cls,
        f: Evaluation,
        domain: Sequence[Sequence[float]],
        periodic: Periodic = False,
        *,
        derivatives: Evaluation | None = None,
        name: str | None = None,
    ) -> Surface:
        """Make a surface of a vectorized callable f(u, v) → (..., 3).

        Parameters
        ----------
        f : callable
            A function of two float64 arrays of one shape that returns points of that shape + (3,).
            It is first called when the surface is fitted or evaluated (see `evaluate`).
        domain : ((u0, u1), (v0, v1)) of float
            The rectangle of the parameters.
        periodic : bool or pair, default False
            One boundary condition for both parameters, or a pair for u and for v: True
            (periodic), False (open, and poles are found, see `assumed_open`); in a pair also one of
            "open", "periodic", "mirrored" (periodic with the other parameter reversed, as on a
            Möbius band or a Klein bottle), "pole" for both ends, or a pair of these (lower bound,
            upper bound).
        derivatives : callable, optional
            ``derivatives(u, v)`` returns (..., 6, 3): x, x_u, x_v, x_uu, x_uv, x_vv. At their first
            use they are compared with numerical ones. By default derivatives are numerical, see
            `derivatives`.
        name : str, optional
            Label of the surface. By default the name of f, or "surface" if it has none, with a
            number from the second surface of that name on: "waves", "waves 2".

        Returns
        -------
        Surface
            The surface.

        Raises
        ------
        InputError
            For an empty or infinite domain, or unknown or contradictory boundary conditions.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> def f(u, v):
        ...     return np.stack([u, v, 0.2 * np.sin(3 * u) * np.cos(3 * v)], axis=-1)
        >>> waves = gm.Surface.from_callable(f, ((-1, 1), (-1, 1)), name="waves")
        >>> gm.fit(waves, (16, 16))
        Spline(16 × 16 cells of waves)

        """
        rectangle, (boundary, assumed) = checked_domain(domain), checked_boundary(periodic)
        name = label(name, "surface", f)
        ends = rectangle, boundary
        return cls(name, f, *ends, derivative_function=derivatives, assumed_open=assumed)

    @classmethod
    def from_sympy(
        cls,
        position: Sequence[sympy.Expr | str | float],
        parameters: Sequence[sympy.Symbol | str],
        domain: Sequence[Sequence[float | str | sympy.Expr]],
        periodic: Periodic = False,
        *,
        name: str | None = None,
    ) -> Surface:
        """Make a surface of three SymPy expressions, or texts, in two parameters.

        Texts are real arithmetic with `+ - * / ** ^ // %`, the elementary functions by their names
        in SymPy, `erf`, `erfc`, `sinc`, `Abs`, `sign`, `floor`, `ceiling`, `Heaviside`, `Min`,
        `Max`, `Piecewise((u, u < v), (v, True))`, and `Sum(u**k, (k, 0, 9))` or `Product`, whose
        terms are written out. They are never run as Python.

        Parameters
        ----------
        position : three of sympy.Expr, str or float
            The components of x(u,v).
        parameters : pair of sympy.Symbol or str
            The parameters u and v.
        domain : ((u0, u1), (v0, v1))
            The rectangle of the parameters: numbers, SymPy numbers, or texts such as "2*pi".
        periodic : bool or pair, default False
            As in `from_callable`.
        name : str, optional
            Label of the surface. By default "surface", then "surface 2", and so on.

        Returns
        -------
        Surface
            The surface.

        Raises
        ------
        InputError
            Unless there are three expressions without further symbols; if one uses another function
            or a truth value as a number, contains complex or huge numbers such as 9**9**9, or is
            too long or nested too deeply for SymPy; for domain and boundary conditions as
            `from_callable`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> tube = gm.Surface.from_sympy(
        ...     ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "sin(v)"), ("u", "v"),
        ...     domain=((0, "2*pi"), (0, "2*pi")), periodic=(True, True),
        ... )
        >>> tube.evaluate(0.0, 0.0)
        array([3., 0., 0.])

        """
        from .expressions import compiled, numbers, two_symbols

        f = compiled(position, two_symbols(parameters))
        rectangle = checked_domain(numbers(domain, "((u0, u1), (v0, v1))"))
        boundary, assumed = checked_boundary(periodic)
        return cls(label(name, "surface"), f, rectangle, boundary, assumed_open=assumed)

    @classmethod
    def from_grid(
        cls,
        points: ArrayLike,
        spacing: Sequence[float] | None = None,
        periodic: Periodic = False,
        *,
        nodata: float | None = None,
        name: str | None = None,
    ) -> Surface:
        """Make a surface of points, or of elevations.

        The spline, which approximates the points, has one cell between any four neighbouring points
        unless `fit` is called with other `cells`.

        Parameters
        ----------
        points : (m, n, 3) or (m, n) array_like
            Points: u and v are the fractional row and column, u = i and v = j at ``points[i, j]``.
            A periodic direction must not repeat its first row at its end. Elevations are a map with
            rows along y and columns along x: ``elevations[i, j]`` is at x = u = j dx, y = v = i dy,
            in the unit of the elevations, and normals point upward.
        spacing : (float, float), optional
            The distances dx, dy of elevations. A negative dy means that rows run from north to
            south.
        periodic : bool or pair, default False
            As in `from_callable`; for points only.
        nodata : float, optional
            The number that means missing data, such as −9999; NaN and masked entries always do. The
            parts of the spline that depend on missing points are left out (see `trim`): up to three
            cells around each.
        name : str, optional
            Label of the surface. By default "grid", then "grid 2", and so on.

        Returns
        -------
        Surface
            The surface: a spline, which approximates the points.

        Raises
        ------
        InputError
            For another shape, infinity, fewer than 4 points in a direction that is not periodic (3
            if it is), a spacing that is zero, missing for elevations or given for points, boundary
            conditions as in `from_callable`, or if every part depends on missing points.

        Warns
        -----
        GaussmapWarning
            If there are numbers that often mean missing data, such as −9999, and no `nodata`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> heights = np.hypot(*np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 4))) ** 3
        >>> hill = gm.Surface.from_grid(heights, spacing=(30.0, 30.0))
        >>> hill.grid.shape, hill.domain
        ((6, 4, 3), ((0.0, 150.0), (0.0, 90.0)))

        """
        from ..spline.missing import without_nodata
        from ..spline.point_grid import points_of_elevations

        checked, domain = "grid" if name is None else text(name, "name"), None
        boundary, assumed = checked_boundary(periodic)
        array = without_nodata(_grid(points), nodata, checked)
        if array.ndim == 2:
            array, domain = points_of_elevations(array, spacing, boundary, checked)
            assumed = False, False
        elif spacing is not None:
            raise InputError(
                "spacing is for elevations of shape (m, n); points (m, n, 3) need none."
            )
        return cls._of_grid(array, boundary, assumed, domain, checked, label(name, "grid"))

    @classmethod
    def _of_grid(
        cls,
        points: NDArray[np.float64],
        boundary: Boundary,
        assumed: Assumed,
        domain: Domain | None,
        name: str,
        labelled: str,
        georeference: Georeference | None = None,
    ) -> Surface:
        """Return the surface of points (m, n, 3), in which missing points are NaN."""
        from ..spline.missing import known_of_grid
        from ..spline.point_grid import spline_of_points
        from .sides import closed_grid

        points, boundary = closed_grid(points, boundary, assumed)
        spline = spline_of_points(points, boundary, name, domain)
        known = known_of_grid(points, spline.domain, boundary, name)
        spline = replace(spline, name=labelled)
        trim = None if known is None else Trim(spline.domain, boundary, (known,))
        return cls(
            spline.name,
            spline.evaluate,
            spline.domain,
            boundary,
            points,
            trim=trim,
            assumed_open=assumed,
            georeference=georeference,
        )

    @classmethod
    def from_nurbs(
        cls,
        degrees: Sequence[int] | object,
        knots: Sequence[ArrayLike] | None = None,
        control_points: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        *,
        periodic: Periodic | None = None,
        name: str | None = None,
    ) -> Surface:
        """Make a surface of a NURBS, given by arrays, or by a surface of geomdl or Splipy.

        The domain is [U[p], U[m]] × [V[q], V[n]] for knots U, V, as usual. A parameter is periodic
        if its two boundaries are the same curve, and the surface is smooth across it. Lines across
        which the surface is not smooth cut it into `pieces`.

        Parameters
        ----------
        degrees : (int, int), or surface of geomdl or Splipy
            The degrees (p, q) along u and v, from 1 to 25. Instead of all arrays, a
            ``geomdl.NURBS.Surface``, ``geomdl.BSpline.Surface`` or ``splipy.Surface``.
        knots : pair of array_like
            The knots U (m + p + 1,) and V (n + q + 1,), which never decrease. Knots inside the
            domain are at most p-fold (q-fold); knots at its bounds need not be multiple.
        control_points : (m, n, 3) array_like
            The control points, in L, not multiplied by their weights.
        weights : (m, n) array_like, optional
            The positive weights; by default all are 1, and the surface is a B-spline.
        periodic : bool or pair, optional
            As in `from_callable`; by default it is detected as described.
        name : str, optional
            Label of the surface. By default "surface", then "surface 2", and so on.

        Returns
        -------
        Surface
            The surface. It is evaluated by compiled code, derivatives included.

        Raises
        ------
        InputError
            If the number of knots does not fit the control points, or knots decrease or tear the
            surface; for weights that are not positive, NaN, or arrays of another shape; for any
            other object, or one with trim curves; and for the boundary conditions that
            `from_callable` refuses.

        References
        ----------
        L. Piegl and W. Tiller, The NURBS Book, 2nd ed., Springer 1997.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> x, z = np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0], indexing="ij")
        >>> arch = np.stack([x, np.array([0.0, 1.0, 0.0])[:, None] + 0 * x, z], axis=-1)
        >>> knots = [0, 0, 0, 1, 1, 1], [0, 0, 1, 1]
        >>> gm.Surface.from_nurbs((2, 1), knots, arch).evaluate(0.5, 0.5)
        array([1. , 0.5, 0.5])

        """
        from .creases import creases, smoothly_closed
        from .nurbs_input import nurbs_of

        nurbs = nurbs_of(degrees, knots, control_points, weights)
        if periodic is None:
            periodic = smoothly_closed(nurbs, 0), smoothly_closed(nurbs, 1)
        boundary, assumed = checked_boundary(periodic)
        u, v = (ends == ("periodic", "periodic") for ends in boundary)
        nurbs = replace(nurbs, periodic=(u, v), creases=creases(nurbs))
        name = label(name, "surface")
        return cls(name, nurbs, nurbs.domain, boundary, assumed_open=assumed)

    def pieces(self) -> tuple[Surface, ...]:
        """Return the smooth pieces of the surface: rectangles of its parameters.

        A NURBS is cut along its creases: the lines u = const and v = const where its normal jumps
        by more than 0.1° somewhere, or the length of the tangent across the line jumps by more than
        a factor of three, so that a spline would fold. Each piece is evaluated from inside on these
        lines.

        Returns
        -------
        tuple of Surface
            The pieces, ordered by u, then by v; parameters are those of the whole. A smooth surface
            is its only piece.

        Examples
        --------
        >>> import gaussmap as gm
        >>> knots = [0, 0, 1, 2, 2], [0, 0, 1, 1]
        >>> roof = [[[0, 0, 0], [0, 5, 0]], [[2, 0, 1], [2, 5, 1]], [[4, 0, 0], [4, 5, 0]]]
        >>> [piece.domain for piece in gm.Surface.from_nurbs((1, 1), knots, roof).pieces()]
        [((0.0, 1.0), (0.0, 1.0)), ((1.0, 2.0), (0.0, 1.0))]

        """
        from .cutting import pieces_of

        return pieces_of(self)

    def transformed(self, matrix: ArrayLike) -> Surface:
        """Return the image of the surface under an affine map, such as a rotation or a scaling.

        Derivatives are mapped exactly. A reflection also reverses u, u → u0 + u1 - u, so that
        normals stay on the same side: outward ones stay outward.

        Parameters
        ----------
        matrix : (3, 3) or (4, 4) array_like
            Points x become matrix x. The last row of a 4 × 4 matrix is 0, 0, 0, 1 and its last
            column a translation.

        Returns
        -------
        Surface
            The surface, with the same name and domain. A reversal of u exchanges the boundary
            conditions at its two bounds.

        Raises
        ------
        InputError
            For another shape or last row, NaN or infinity, or a singular matrix.
        SurfaceError
            If a surface that was given by points becomes too large or too small for float64.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> raised = np.diag([2.0, 2.0, 2.0, 1.0])
        >>> raised[2, 3] = 5.0
        >>> gm.surfaces.sphere().transformed(raised).evaluate(0.0, 0.0)
        array([2., 0., 5.])

        """
        map_ = affine_map(matrix)
        return replace(self._moved(map_, map_.reflects), georeference=None)

    def flipped(self) -> Surface:
        """Return the same points with opposite normals: u is reversed, u → u0 + u1 - u.

        Returns
        -------
        Surface
            The surface, with the same name and domain. The boundary conditions at the two bounds of
            u are exchanged.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> sphere = gm.surfaces.sphere()
        >>> for surface in (sphere, sphere.flipped()):
        ...     x, x_u, x_v, *_ = surface.derivatives(3.0, 0.25)
        ...     print(bool(x @ np.cross(x_u, x_v) > 0.0))
        True
        False

        """
        return self._moved(IDENTITY, turned=True)

    def _moved(self, map_: AffineMap, turned: bool) -> Surface:
        (low, high), along_v = self.boundary
        boundary: Boundary = (high, low) if turned else (low, high), along_v
        trim = self.trim.turned(boundary) if turned and self.trim else self.trim
        moved = replace(self, boundary=boundary, trim=trim, derivative_function=None)
        if self.grid is None:
            return replace(moved, function=Moved.of(self).then(map_, turned))
        grid = moved_grid(self.grid, boundary, map_, turned)
        spline = fit_grid(grid, self.domain, boundary, self.name)
        return replace(moved, function=spline.evaluate, grid=grid)

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """The smallest and the largest x, y, z (2, 3) of the surface inside its trim.

        These numbers are six values of `GaussMap.support`, which states how exact they are.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.surfaces.torus(major=1.0, minor=0.35).bounds.round(12)
        array([[-1.35, -1.35, -0.35],
               [ 1.35,  1.35,  0.35]])

        """
        return self._bounds_of()

    def trimmed(
        self,
        loops: Any | None = None,  # noqa: ANN401
        *,
        within: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.bool_]]
        | None = None,
    ) -> Surface:
        """Return the part of the surface inside closed polygons, or where a predicate holds.

        Samples, their coverage, weights, meshes and silhouettes are those of the part. Parabolic
        points are still those of the whole surface, and Gaussian images are refused.

        Parameters
        ----------
        loops : sequence of (k, 2) array_like, or Polygon, optional
            Closed polygons of points u, v, whose first point may be repeated at the end: a point is
            inside by the even-odd rule, so that a polygon in another one is a hole. Or a Polygon or
            MultiPolygon of Shapely, or any other object with the same ``__geo_interface__``. Loops
            may run beyond the seam of a periodic direction: a point is inside if it, or a copy
            shifted by whole periods, is. The copies may not overlap.
        within : callable, optional
            ``within(u, v)`` takes two float64 arrays (k,) of parameters in the domain, and returns
            booleans (k,). Regions smaller than an eighth of a patch of the spline may be missed. If
            the predicate consists of inequalities between NumPy functions, joined by &, | and ~,
            undecided boxes (see `SamplingReport.undecided`) outside of the part are excluded.

        Returns
        -------
        Surface
            The part. If the surface is already trimmed, or if loops and a predicate are given, all
            conditions hold. A callable may return NaN outside of the trim: there the spline
            continues it for up to three cells.

        Raises
        ------
        InputError
            For loops with fewer than 3 points, with NaN or infinity, of another shape, more than
            100 periods away, or overlapping their copies; for a predicate that is not callable; or
            if neither is given.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> square = np.array([(1, 1), (4, 1), (4, 4), (1, 4)])
        >>> window = gm.surfaces.torus().trimmed([square, 1.5 + square / 4])  # with a hole
        >>> samples = gm.sample(window, 200, cells=(16, 16))
        >>> len(samples), bool(window.trim.contains(samples.uv).all())
        (200, True)
        >>> sheets = gm.surfaces.torus().trimmed(within=lambda u, v: np.abs(v - 3) < 1)

        """
        trim = trimmed_by(
            self.trim, loops, within, self.domain, self.boundary, self.name, traced_condition
        )
        return replace(self, trim=trim)


def _grid(points: ArrayLike) -> NDArray[np.float64]:
    """Return points or elevations with NaN in place of masked entries."""
    array = with_gaps(points, "a grid")
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] != 3):
        raise InputError(
            f"a grid must have the shape (m, n, 3), or (m, n) for elevations, not {array.shape}."
        )
    return array


def label(name: str | None, kind: str, function: object = None) -> str:
    """Return `name` if it is given, or else a default: the name of `function`, or `kind`.

    Default names are distinct in a process: "waves", then "waves 2". Raises InputError if `name` is
    neither None nor a text.
    """
    if name is not None:
        return text(name, "name")
    own = getattr(function, "__name__", "")
    base = own if isinstance(own, str) and own.isidentifier() else kind  # not "<lambda>"
    with _lock:
        _used[base] += 1
        return base if _used[base] == 1 else f"{base} {_used[base]}"
