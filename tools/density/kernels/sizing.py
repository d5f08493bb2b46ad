"""The target density of samples, which follows from the curvature.

With the density w, the sizing function is 1/√w: samples are to lie within r/√w of every point, for
a radius r that is the same everywhere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ....generated.patch import largest_curvature
from ....runtime.machine_code.jit import inline


class TargetDensity(NamedTuple):
    """Samples per area, up to a factor: a κ^(2e) + b |K|^e, clipped to floor and ceiling.

    κ is the larger principal curvature in modulus, a the curvature weight, b the Gauss weight and e
    the exponent. Curvatures are those of the scaled surface.
    """

    floor: float = 0.0
    curvature_weight: float = 0.0
    gauss_weight: float = 0.0
    exponent: float = 1.0
    ceiling: float = math.inf


@inline
def at_most(value, limit):
    """Return the smaller one of a value and a limit; the limit if the value is NaN."""
    return value if value < limit else limit


@inline
def density_of(K, H, radius, target):
    """Return the target density for the Gaussian and mean curvature.

    Radii of curvature below `radius` count as `radius`.
    """
    density = 0.0
    limit = 1.0 / (radius * radius)
    if target.curvature_weight > 0.0:
        k = largest_curvature(K, H)
        density += target.curvature_weight * math.pow(at_most(k * k, limit), target.exponent)
    if target.gauss_weight > 0.0:
        density += target.gauss_weight * math.pow(at_most(abs(K), limit), target.exponent)
    return max(min(density, target.ceiling), target.floor)
