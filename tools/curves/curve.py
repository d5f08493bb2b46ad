"""A planar curve: a function x(t), its domain, and whether it is closed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import real_array, text
from ...runtime.base.errors import InputError, shown
from ...runtime.base.evaluation import evaluated
from ...runtime.domain.domain import Interval, checked_interval
from ...runtime.spline.spline import short_label

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True, eq=False, repr=False)
class Curve:
    """A planar parametric curve x(t).

    Make one with `from_callable`, `from_sympy` or `from_points`. Normals are the tangent turned
    clockwise by 90°: outward on a circle with counter-clockwise parameterization.

    Attributes
    ----------
    name : str
        Label of the curve.
    function : callable
        ``function(t)`` gets a float64 array and returns points of its shape + (2,).
    domain : (float, float)
        The interval of the parameter.
    periodic : bool
        Whether the curve is closed and smooth at its ends.
    points : (m, 2) float64 array or None
        The points of a curve that was given by points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> corner = gm.curves.Curve.from_points([(0, 0), (1, 0), (2, 1), (2, 2)], name="corner")
    >>> corner
    Curve(corner: t 0 to 3, open)
    >>> corner.name, corner.domain, corner.periodic, corner.points.shape
    ('corner', (0.0, 3.0), False, (4, 2))
    >>> corner.function([0.0, 3.0]).shape
    (2, 2)

    """

    name: str
    function: Callable[[NDArray[np.float64]], ArrayLike]
    domain: Interval
    periodic: bool
    points: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        text(self.name, "name")
        if not callable(self.function):
            raise InputError(
                "the function of a curve must be callable as f(t), and "
                f"{type(self.function).__name__} is not."
            )
        object.__setattr__(self, "domain", checked_interval(self.domain))
        _yes_or_no(self.periodic, "periodic")

    def __repr__(self) -> str:
        low, high = self.domain
        kind = "closed" if self.periodic else "open"
        return f"Curve({short_label(self.name)}: t {low:g} to {high:g}, {kind})"

    @classmethod
    def from_callable(
        cls,
        f: Callable[[NDArray[np.float64]], ArrayLike],
        domain: Sequence[float],
        periodic: bool = False,
        *,
        name: str = "curve",
    ) -> Curve:
        """Make a curve of a vectorized callable f(t) → (..., 2).

        Parameters
        ----------
        f : callable
            Gets a float64 array and returns points of its shape + (2,). It is first called when the
            curve is fitted or evaluated (see `evaluate`).
        domain : (float, float)
            The interval (t0, t1) of the parameter.
        periodic : bool, default False
            Whether the curve is closed and smooth at its ends.
        name : str, default "curve"
            Label of the curve.

        Returns
        -------
        Curve
            The curve.

        Raises
        ------
        InputError
            For an empty or infinite domain, or if `periodic` is not True or False.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> def f(t):
        ...     return np.stack([t, t**2], axis=-1)
        >>> gm.curves.fit(gm.curves.Curve.from_callable(f, (-1, 1), name="parabola"), 8)
        CurveSpline(8 pieces of parabola)

        """
        return cls(name, f, domain, periodic)  # pyright: ignore[reportArgumentType]

    @classmethod
    def from_sympy(
        cls,
        position: Sequence[sympy.Expr | str | float],
        parameter: sympy.Symbol | str,
        domain: Sequence[float | str | sympy.Expr],
        periodic: bool = False,
        *,
        name: str = "curve",
    ) -> Curve:
        """Make a curve of two SymPy expressions, or texts, in one parameter.

        Parameters
        ----------
        position : pair of sympy.Expr, str or float
            The components of x(t); texts are read as in `Surface.from_sympy`.
        parameter : sympy.Symbol or str
            The parameter t.
        domain : pair
            The interval (t0, t1): numbers, SymPy numbers, or texts such as "2*pi".
        periodic : bool, default False
            Whether the curve is closed and smooth at its ends.
        name : str, default "curve"
            Label of the curve.

        Returns
        -------
        Curve
            The curve.

        Raises
        ------
        InputError
            Unless there are two expressions without further symbols, for texts that
            `Surface.from_sympy` refuses, and as `from_callable`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(
        ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True
        ... )
        >>> circle.evaluate(0.0)
        array([1., 0.])

        """
        from ...runtime.surface.expressions import compiled, numbers, one_symbol

        f = compiled(position, one_symbol(parameter))
        return cls.from_callable(f, numbers(domain, "(t0, t1)"), periodic, name=name)

    @classmethod
    def from_points(cls, points: ArrayLike, closed: bool = False, *, name: str = "points") -> Curve:
        """Make a curve that approximates points, which should be almost evenly spaced.

        The parameter is t = k near ``points[k]``; the spline does not interpolate the points. The
        spline has one piece between any two neighbouring points, unless `fit` gets another number
        of `pieces`.

        Parameters
        ----------
        points : (m, 2) array_like
            At least 3 points. A closed curve must not repeat its first point at its end.
        closed : bool, default False
            Whether the curve is closed.
        name : str, default "points"
            Label of the curve.

        Returns
        -------
        Curve
            The curve.

        Raises
        ------
        InputError
            For another shape, fewer than 3 points, or NaN or infinity (with its position).

        Examples
        --------
        >>> import gaussmap as gm
        >>> square = gm.curves.Curve.from_points([(0, 0), (1, 0), (1, 1), (0, 1)], closed=True)
        >>> square.periodic, square.domain
        (True, (0.0, 4.0))

        """
        from .curve_quasi_interpolant import checked_points, spline_of_points

        text(name, "name")
        is_closed = _yes_or_no(closed, "closed")
        array = checked_points(real_array(points, "points of a curve"), is_closed, name)
        domain = 0.0, float(len(array) if is_closed else len(array) - 1)
        spline = spline_of_points(array, domain, is_closed, name)
        return cls(name, spline.evaluate, domain, is_closed, array)

    def evaluate(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the points x(t).

        Parameters
        ----------
        t : array_like
            Parameters.

        Returns
        -------
        (..., 2) float64 array
            The points.

        Raises
        ------
        SurfaceError
            If the callable raises or returns another shape than (..., 2), values that are not real
            numbers, NaN or infinity.
        InputError
            If the parameters are not real numbers, or lie outside the domain of a curve that was
            given by points.

        Examples
        --------
        >>> import gaussmap as gm
        >>> line = gm.curves.Curve.from_sympy(("t", "2*t"), "t", (0, 1))
        >>> line.evaluate([0.0, 0.5])
        array([[0. , 0. ],
               [0.5, 1. ]])

        """
        parameters = {"t": real_array(t, "t")}
        return evaluated(self.function, parameters, 2, f"curve {self.name!r}")


def _yes_or_no(value: object, name: str) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} must be True or False, not {shown(value)}.")
    return bool(value)
