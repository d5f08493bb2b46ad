"""Bounds of rounding errors and what is decided by them: each with its unit and its reason.

NumPy code and kernels read the same numbers. ε = 2⁻⁵² is the distance from 1 to the next float64.
"""

from __future__ import annotations

__all__ = [
    "ACCURATE",
    "ANGLE_ERROR",
    "CUBIC_ERROR",
    "DATA_ERROR",
    "DOUBLE_ROOT",
    "FORM_ERROR",
    "LATTICE_ERROR",
    "NEAR_SINGULAR_POINT",
    "PARAMETER_ERROR",
    "SHORT_CONTROL_NORMAL",
    "SINGULAR_POINT",
    "VANISHING",
]

# Of coordinates, relative to the largest one: they carry a few roundings, at most 64 ε.
DATA_ERROR = 2.0**-46
# Of the linear forms A, B, C, P, Q at a unit normal, relative to the largest difference of the
# coefficients of a patch: the integer weights of a vector sum to at most 12 in modulus, and a
# scalar product adds three roundings, so that 2⁻⁴³ leaves a factor of 6 to spare.
FORM_ERROR = 2.0**-43
# U, V, W are compared with the bound of their error; D has to exceed it by this factor, so that
# u = U/D and v = V/D have as many digits as the factor.
ACCURATE = 2.0**16
# Of the quadratic forms at a point of an icosphere, computed from the linear ones at the corners of
# its face, relative to the square of the largest of these.
LATTICE_ERROR = 2.0**-44
# Of the direction of a control normal, as an angle (radians): at most this times one plus the
# square of the tangents relative to its length.
ANGLE_ERROR = 2.0**-40
# A control normal shorter than this, relative to the square of the tangents, has no direction: its
# patch has a singular point there. It is far above the rounding of a cross product.
SHORT_CONTROL_NORMAL = 2.0**-30
# A point is singular where the normal is shorter than this, relative to that at the centre of its
# patch; as far as this (in u, v) curvatures are taken from it.
SINGULAR_POINT = 2.0**-20
# A point is near a singular point where the normal is shorter than this, relative to the square of
# the tangents: parameters with few digits do not give its direction there.
NEAR_SINGULAR_POINT = 2.0**-12
# A normal, or a slope along it, is zero where it is shorter than this, relative to the tangents
# that it is a product of, or to the largest normal of the patch: 4096 ε, far above the rounding of
# such a product.
VANISHING = 2.0**-40
# Of a coefficient of the parabolic cubic, or of the cubic of its directions, relative to the
# product of the lengths of the vectors in its terms: 256 ε.
CUBIC_ERROR = 2.0**-44
# Of parameters in the triangle u, v, 1 − u − v ≥ 0, whose sides have length 1.
PARAMETER_ERROR = 1e-12
# Two roots, directions (radians) or places (u, v) that differ by less than this are one that is
# double, and an imaginary part below it is zero: rounding by ε parts a double root by √ε ≈ 1.5e-8,
# times the condition of the cubic, for which a factor of 67 is left.
DOUBLE_ROOT = 1e-6
