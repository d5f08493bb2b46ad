"""Fitting a spline to a planar curve."""

from __future__ import annotations

import numpy as np

from ...runtime.base.checks import whole_number
from ...runtime.base.errors import InputError, SurfaceError, in_memory
from ...runtime.base.scales import apart, not_too_large
from .curve import Curve
from .curve_quasi_interpolant import spline_of_points, spline_of_values
from .curve_spline import CurveSpline

DEFAULT_PIECES = 64


@in_memory
def fit(curve: Curve, pieces: int | None = None) -> CurveSpline:
    """Approximate a planar curve by a C¹ quadratic spline.

    The quasi-interpolant is exact on quadratics. The error of positions falls with the third power
    of the length of a piece, that of normals with the second (docs/guides/more.md).

    Parameters
    ----------
    curve : Curve
        The curve.
    pieces : int, optional
        The number of arcs, at least 3 for a closed curve. By default 64, or one between
        neighbouring points of a curve that is given by points.

    Returns
    -------
    CurveSpline
        The spline.

    Raises
    ------
    InputError
        For invalid `pieces`, and more of them than a narrow domain can hold.
    SurfaceError
        If the curve cannot be evaluated, or does not close although it is periodic.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
    >>> gm.curves.fit(circle, 16).turning_number
    1

    """
    if not isinstance(curve, Curve):
        raise InputError(f"fit takes a Curve, not {type(curve).__name__}.")
    if pieces is None and curve.points is not None:
        return spline_of_points(curve.points, curve.domain, curve.periodic, curve.name)
    count = whole_number(DEFAULT_PIECES if pieces is None else pieces, "pieces")
    if curve.periodic and count < 3:
        raise InputError(f"a closed curve needs at least 3 pieces, not {count}.")
    low, high = curve.domain
    places = low + (high - low) * (np.arange(2 * count + 1) / (2 * count))
    if not (np.diff(places) > 0.0).all():
        raise InputError(f"the domain of t is too narrow for {count} pieces: ({low}, {high}).")
    values = not_too_large(curve.evaluate(places), curve.name)
    if curve.periodic:
        if apart(values[-1], values[0], values[:, None]):
            raise SurfaceError(f"curve {curve.name!r} does not close: its two ends differ.")
        values[-1] = values[0]
    return spline_of_values(values, curve.domain, curve.periodic, curve.name)
