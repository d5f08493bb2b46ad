"""How far a spline is from what it approximates; `fitting` measures it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Misfit"]


@dataclass(frozen=True, slots=True)
class Misfit:
    """How far a spline is from the surface or the data that it approximates.

    Both are compared at equal parameters. So `distance` bounds the distance of the two surfaces at
    these places from above, and rather well: the spline slides little along the surface.

    Attributes
    ----------
    distance : float
        The largest distance, in L: over thousands of places that the fit did not use, lines of
        hundreds of them among these; over all points of data.
    rms : float
        The root mean square of the distance, in L, over places that are spread evenly over the
        domain of the parameters; over all points of data.
    angle : float or None
        The largest angle, in degrees, between the normals of spline and surface, without the poles
        and singular points themselves; None for data, which have no normals.

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
