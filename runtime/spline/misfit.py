"""The misfit of a spline to the surface or data that it approximates; `fitting` measures it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Misfit:
    """The distance of a spline from the surface or the data that it approximates.

    Points of both are compared at equal parameters, so that `distance` is an upper bound of the
    distance of the surfaces at these points, and a close one: tangential differences are small.

    Attributes
    ----------
    distance : float
        The largest distance, in L, at thousands of points that the fit did not use, including
        hundreds on each of several lines. For data, at all data points, except points that are
        trimmed off or where the spline depends on missing points.
    rms : float
        The root mean square of the distance, in L, over points that are evenly distributed in the
        domain. For data, over the same data points as `distance`.
    angle : float or None
        The largest angle, in degrees, between the normals of spline and surface at parameters other
        than poles and singular points; None for data, which have no normals.

    Examples
    --------
    >>> import gaussmap as gm
    >>> misfit = gm.fit("torus", (64, 64)).misfit
    >>> misfit.rms < misfit.distance < 1.1e-5
    True
    >>> f"{misfit.angle:.2f}°"
    '0.03°'
    >>> finer = gm.fit("torus", (128, 128)).misfit  # order 3, and order 2 for normals
    >>> bool(7 < misfit.distance / finer.distance < 9), bool(3.5 < misfit.angle / finer.angle < 4.5)
    (True, True)

    """

    distance: float
    rms: float
    angle: float | None
