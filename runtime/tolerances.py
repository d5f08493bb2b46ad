"""Bounds of rounding errors and what is decided by them: each with its unit and its reason.

NumPy code and kernels read the same numbers. ε = 2⁻⁵² is the distance from 1 to the next float64.
"""

from __future__ import annotations

__all__ = [
    "ACCURATE",
    "ANGLE_ERROR",
    "DATA_ERROR",
    "FORM_ERROR",
    "LATTICE_ERROR",
    "SHORT_CONTROL_NORMAL",
    "SINGULAR_POINT",
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
