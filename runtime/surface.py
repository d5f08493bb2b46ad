"""A surface: how to evaluate x(u,v), over which rectangle, with which boundary conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import parameter_arrays, real_array
from .domain import Boundary, Domain, Periodicity, checked_boundary, checked_domain
from .errors import InputError
from .evaluation import evaluated

if TYPE_CHECKING:
    import sympy

__all__ = ["Surface"]

Evaluation = Callable[[NDArray[np.float64], NDArray[np.float64]], ArrayLike]


@dataclass(frozen=True, eq=False)
class Surface:
    """A parametric surface x(u,v).

    Make one with `from_callable`, `from_sympy` or `from_grid`, or take one of `gaussmap.surfaces`.

    `function(u, v)` gets two float64 arrays of one shape and returns points of that shape + (3,).
    `boundary` holds, for u and for v, the boundary conditions at the low and the high end: "open"
    (an edge), "periodic", "mirrored" (periodic with the other parameter reversed, as on the Möbius
    band) or "pole" (for v: the end is one point and the opposite meridian continues it). Normals
    point along x_u × x_v. `grid` holds the points (m, n, 3) of a surface that was given by points.
    """

    name: str
    function: Evaluation
    domain: Domain
    boundary: Boundary
    grid: NDArray[np.float64] | None = None

    @classmethod
    def from_callable(
        cls,
        f: Evaluation,
        domain: Sequence[Sequence[float]],
        periodic: Sequence[Periodicity] = (False, False),
        *,
        name: str = "surface",
    ) -> Surface:
        """Make a surface of a vectorized callable f(u, v) → (..., 3).

        `domain` is ((u0, u1), (v0, v1)); `periodic` says for u and for v whether the surface
        closes: True or False, or in words as in `boundary` above, one for both ends or a pair (low,
        high). Raises InputError for an empty or infinite domain or an unknown word. The callable is
        first called when the surface is fitted or evaluated (see `evaluate`).
        """
        if not callable(f):
            raise InputError(f"f must be callable as f(u, v), and {type(f).__name__} is not.")
        return cls(name, f, checked_domain(domain), checked_boundary(periodic))

    @classmethod
    def from_sympy(
        cls,
        position: Sequence[sympy.Expr | str | float],
        parameters: Sequence[sympy.Symbol | str],
        domain: Sequence[Sequence[float | str | sympy.Expr]],
        periodic: Sequence[Periodicity] = (False, False),
        *,
        name: str = "surface",
    ) -> Surface:
        """Make a surface of three SymPy expressions (or strings) in the two `parameters`.

        `domain` and `periodic` are as in `from_callable`; the domain may hold SymPy numbers, or
        strings such as "2*pi".

        Texts are arithmetic with `+ - * / ** ^ // %`, SymPy's elementary functions, `Piecewise`,
        `Max`, `Sum(f, (k, 0, 9))`, and what SymPy computes exactly, such as `legendre(4, u)` or
        `factorial(5)`. They are never run as Python. Raises InputError unless there are three
        expressions without further symbols, and if one uses another function, is longer than
        20,000 characters, nested too deeply, or holds numbers such as 9**9**9.
        """
        from .expressions import compiled, numbers, two_symbols

        f = compiled(position, two_symbols(parameters))
        return cls(name, f, checked_domain(numbers(domain)), checked_boundary(periodic))

    @classmethod
    def from_grid(
        cls,
        points: ArrayLike,
        spacing: Sequence[float] | None = None,
        periodic: Sequence[Periodicity] = (False, False),
        *,
        name: str = "grid",
    ) -> Surface:
        """Make a surface of points (m, n, 3), or of elevations (m, n) with spacing=(dx, dy).

        Points: u and v are the fractional row and column, u = i and v = j at points[i, j]. A
        periodic direction must not repeat its first row at its end. Elevations are a map with rows
        along y and columns along x: elevations[i, j] stands at x = u = j dx, y = v = i dy, in the
        unit of the elevations, and normals point upward. A negative dy means that rows run from
        north to south.

        One spline cell stands between any four neighbouring points, so that nothing is lost;
        `fit(cells=...)` chooses otherwise. Raises InputError for another shape, NaN or infinity
        (and says where), fewer than 4 points in a direction that is not periodic (3 if it is), or
        spacing that is missing, zero or not wanted.
        """
        from .grid import points_of_elevations, spline_of_points

        array, boundary, domain = _grid(points), checked_boundary(periodic), None
        if array.ndim == 2:
            array, domain = points_of_elevations(array, spacing, boundary, name)
        elif spacing is not None:
            raise InputError(
                "spacing is for elevations of shape (m, n); points (m, n, 3) need none."
            )
        spline = spline_of_points(array, boundary, name, domain)
        return cls(name, spline.evaluate, spline.domain, boundary, array)

    def evaluate(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the points x(u, v), shape (..., 3), for parameters that broadcast together.

        Raises SurfaceError if the callable raises, returns another shape than (..., 3) or anything
        but real numbers, or gives NaN or infinity, and says where; InputError if the parameters are
        no real numbers, or lie outside a surface that was given by points.
        """
        u_array, v_array = parameter_arrays(u, v)
        parameters = {"u": u_array, "v": v_array}
        return evaluated(self.function, parameters, 3, f"surface {self.name!r}")


def _grid(points: ArrayLike) -> NDArray[np.float64]:
    array = real_array(points, "a grid")
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] != 3):
        raise InputError(
            f"a grid must have the shape (m, n, 3), or (m, n) for elevations, not {array.shape}."
        )
    return array
