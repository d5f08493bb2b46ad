"""The input of NURBS surfaces, from arrays or objects of geomdl or Splipy, and its checks."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.advice import is_of_geomdl, is_of_splipy
from ..base.aliases import Array
from ..base.checks import finite_array, real_array, whole_number
from ..base.errors import InputError, shown
from .nurbs import Nurbs

# The largest degree that Open CASCADE allows.
MOST_DEGREE = 25
# Control points whose weight is below this fraction of the largest weight do not affect the centre.
LIGHT = 0.1


def nurbs_of(degrees: Any, knots: Any, control_points: Any, weights: Any) -> Nurbs:  # noqa: ANN401
    """Return the NURBS surface that is given by arrays, or by an object passed as `degrees`.

    Raises InputError if the arguments do not define a surface.
    """
    definition: tuple[Any, ...] = degrees, knots, control_points, weights
    if knots is None and control_points is None and weights is None:
        definition = _definition_of(degrees)
    degrees, knots, control_points, weights = definition
    p, q = (
        whole_number(x, f"the degree of {name}", most=MOST_DEGREE)
        for x, name in zip(_pair(degrees, "degrees"), "uv", strict=True)
    )
    points = finite_array(control_points, ("m", "n", 3), "control_points")
    knots_u, knots_v = (
        _knots(x, degree, count, name)
        for x, degree, count, name in zip(
            _pair(knots, "knots"), (p, q), points.shape, "uv", strict=False
        )
    )
    factors = np.ones(points.shape[:2]) if weights is None else _weights(weights, points.shape[:2])
    # The centre must be near the control points with large weights: the surface is near these
    # points. If the centre were far away, coordinates relative to it would differ little, relative
    # to their size, and lose digits.
    heavy = points[factors >= LIGHT * factors.max()]
    centre = heavy.min(axis=0) / 2 + heavy.max(axis=0) / 2
    points = points - centre
    if weights is not None:
        points = np.concatenate([points * factors[:, :, None], factors[:, :, None]], axis=2)
    domain = (
        (float(knots_u[p]), float(knots_u[-p - 1])), (float(knots_v[q]), float(knots_v[-q - 1])),
    )  # fmt: skip
    return Nurbs((p, q), (knots_u, knots_v), np.ascontiguousarray(points), centre, domain)


def _pair(values: Any, name: str) -> tuple[Any, Any]:  # noqa: ANN401 - what a user gives
    try:
        u, v = values
    except Exception:  # conversion may raise anything
        raise InputError(f"{name} must be a pair, one for u and one for v.") from None
    return u, v


def _knots(values: ArrayLike, degree: int, count: int, name: str) -> Array:
    """Return the knots of u or v as an array; InputError unless they fit `count` control points."""
    knots = finite_array(values, None, f"the knots of {name}")
    if count <= degree:
        raise InputError(
            f"degree {degree} in {name} needs at least {degree + 1} control points along {name}, "
            f"and there are {count}."
        )
    if knots.shape != (count + degree + 1,):
        raise InputError(
            f"{count} control points of degree {degree} along {name} need {count + degree + 1} "
            f"knots, not {knots.size if knots.ndim == 1 else shown(knots.shape)}."
        )
    falls = np.flatnonzero(np.diff(knots) < 0.0)
    if len(falls):
        k = int(falls[0])
        raise InputError(
            f"the knots of {name} decrease: {float(knots[k])!r} is followed by "
            f"{float(knots[k + 1])!r}."
        )
    low, high = float(knots[degree]), float(knots[count])
    if not 0.0 < high - low < np.inf:
        raise InputError(f"the knots of {name} leave no domain: it is from {low!r} to {high!r}.")
    _check_multiplicities(knots, degree, name)
    return knots


def _check_multiplicities(knots: Array, degree: int, name: str) -> None:
    """Raise InputError if a knot occurs too often for the degree.

    Inside the domain such a knot tears the surface; elsewhere, some control points have no effect.
    """
    values, counts = np.unique(knots, return_counts=True)
    inside = (values > knots[degree]) & (values < knots[-degree - 1])
    for many, reason in (
        (inside & (counts > degree), "there, the surface would be torn"),
        (counts > degree + 1, "some control points would do nothing"),
    ):
        if many.any():
            k = int(np.argmax(many))
            raise InputError(
                f"the knot {float(values[k])!r} of {name} occurs {counts[k]} times, which is too "
                f"often for degree {degree}: {reason}."
            )


def _weights(values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return weights scaled so that the largest is about 1; InputError unless all are positive."""
    weights = finite_array(values, shape, "weights")
    if not (weights > 0.0).all():
        i, j = np.argwhere(~(weights > 0.0))[0].tolist()
        kind = "zero" if weights[i, j] == 0.0 else "negative"
        raise InputError(
            f"a NURBS with a {kind} weight has no finite surface everywhere: weights[{i}, {j}] is "
            f"{float(weights[i, j])!r}, and all must be positive."
        )
    return np.ldexp(weights, -int(np.frexp(weights.max())[1]))


# --- objects --------------------------------------------------------------------------------------


def _definition_of(value: object) -> tuple[Any, ...]:
    """Return degrees, knots, points and weights of a geomdl or Splipy surface.

    The attributes of the object tell which kind it is. Raises InputError for other objects, and for
    features that cannot be converted.
    """
    if is_of_geomdl(value):
        return _of_geomdl(value)
    if is_of_splipy(value):
        return _of_splipy(value)
    raise InputError(
        f"from_nurbs takes degrees, knots and control_points, or one surface of geomdl or "
        f"Splipy, not {shown(value)}."
    )


def _of_geomdl(value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - it is not imported
    """Return the definition of a `geomdl.BSpline.Surface` or `geomdl.NURBS.Surface`.

    geomdl stores the control points as one list in which v varies fastest, not multiplied by their
    weights.
    """
    if len(getattr(value, "trims", ())):
        raise InputError(
            "this surface of geomdl has trim curves, which are not taken over: remove them "
            "(surface.trims = []) and trim what from_nurbs returns."
        )
    shape = value.ctrlpts_size_u, value.ctrlpts_size_v
    try:
        points = real_array(value.ctrlpts, "control points").reshape(*shape, -1)
        weights = real_array(value.weights, "weights").reshape(shape) if value.rational else None
    except ValueError:
        raise InputError(
            f"this surface of geomdl does not have {shape[0]} × {shape[1]} control points yet."
        ) from None
    return (
        (value.degree_u, value.degree_v),
        (value.knotvector_u, value.knotvector_v),
        points,
        weights,
    )


def _of_splipy(value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - it is not imported
    """Return the definition of a `splipy.Surface`.

    The control points of a rational surface are stored as w x, w y, w z, w. In a periodic
    direction, Splipy does not repeat the first control points at the end; here they are appended.
    """
    bases = tuple(value.bases)
    points = real_array(value.controlpoints, "control points")
    if len(bases) != 2 or points.ndim != 3:
        raise InputError(
            f"from_nurbs takes surfaces, and this object of Splipy has {len(bases)} parameters."
        )
    for axis, basis in enumerate(bases):
        repeated = range(int(basis.periodic) + 1)
        points = np.concatenate([points, points.take(repeated, axis=axis)], axis=axis)
    weights = points[:, :, -1] if value.rational else None
    if weights is not None:
        _weights(weights, weights.shape)  # checked before the division
        points = points[:, :, :-1] / weights[:, :, None]
    degrees = tuple(int(basis.order) - 1 for basis in bases)
    return degrees, tuple(basis.knots for basis in bases), points, weights
