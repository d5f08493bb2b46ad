"""Bounds of rounding errors and thresholds derived from them, each with its unit and its reason.

NumPy code and kernels read the same numbers. ε = 2⁻⁵² is the distance from 1 to the next float64. A
comment says which quantity the bound is for.
"""

from __future__ import annotations

__all__ = [
    "ACCURATE",
    "ANGLE_ERROR",
    "CAP_RADIUS_ERROR",
    "CIRCLE_HEIGHT_ERROR",
    "CUBIC_ERROR",
    "CURVATURE_ERROR",
    "DATA_ERROR",
    "DERIVATIVE_ERROR",
    "DIFFERENCE_ERROR",
    "DOUBLE_ROOT",
    "FLAT_SURFACE",
    "FORM_ERROR",
    "LENGTH_ERROR",
    "MEETING",
    "NEAR_SINGULAR_POINT",
    "NORMAL_ERROR",
    "NORMAL_NOISE",
    "NO_AREA",
    "PARAMETER_ERROR",
    "PATCH_ERROR",
    "QUALITY_GAIN",
    "RADIUS_ERROR",
    "ROTATION_ERROR",
    "SAME_PARAMETER",
    "SHORT_CONTROL_NORMAL",
    "SINGULAR_POINT",
    "TRIPLE_PRODUCT_ERROR",
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
# Of the direction of a control normal, as an angle (radians): at most this times one plus the
# square of the tangents relative to its length.
ANGLE_ERROR = 2.0**-40
# A control normal shorter than this, relative to the square of the tangents, has no direction: its
# patch has a singular point there. The threshold is far above the rounding error of a cross
# product.
SHORT_CONTROL_NORMAL = 2.0**-30
# A point is singular where the normal is shorter than this, relative to the normal at the centre of
# its patch; its curvatures are taken at this distance (in u, v) from it.
SINGULAR_POINT = 2.0**-20
# A point is near a singular point where the normal is shorter than this, relative to the square of
# the tangents: parameters with few digits do not give its direction there.
NEAR_SINGULAR_POINT = 2.0**-12
# A normal, or a slope along it, is zero if it is shorter than this, relative to the product of its
# tangents, or to the largest normal of the patch: 4096 ε, far above the rounding of such a product.
VANISHING = 2.0**-40
# Of a coefficient of the parabolic cubic, or of the cubic of its directions, relative to the
# product of the lengths of the vectors in its terms: 256 ε.
CUBIC_ERROR = 2.0**-44
# Of parameters in the triangle u, v, 1 − u − v ≥ 0, whose legs have length 1.
PARAMETER_ERROR = 1e-12
# Two roots, directions (radians) or parameter pairs (u, v) that differ by less than this are a
# double root, and a smaller imaginary part is zero: a rounding error ε splits a double root by √ε ≈
# 1.5e-8, times the condition number of the cubic, for which a factor of 67 is left.
DOUBLE_ROOT = 1e-6
# Of the radius of a cap in degrees: the iteration has converged if it grows by less than this.
CAP_RADIUS_ERROR = 1e-12
# Of the height of a circle of latitude on the unit sphere: free points are farther away from it.
CIRCLE_HEIGHT_ERROR = 1e-12
# The flip or collapse of an edge must raise a cosine, or the tangent of an angle of a triangle, by
# at least this, which exceeds their rounding errors.
QUALITY_GAIN = 1e-14
# A triangle whose smallest angle (radians) is below this counts as one without area: its area
# vanishes in files of single precision.
NO_AREA = 1e-6
# Of K, H and 1 + 2 d H + d² K relative to their terms, in units of the last place.
CURVATURE_ERROR = 4.0
# Of a principal curvature times the diagonal of the bounding box, relative to the rounding of
# coordinates in units of the diagonal: on a surface that is given by values only (second
# differences of them), and on a spline, where this is multiplied by the square of its number of
# cells. Measured values on planes, cylinders and cones are 1.3e7 and 40.
DERIVATIVE_ERROR, PATCH_ERROR = 2.0**26, 2.0**8
# Of a difference of two coefficients of a planar spline, in units of the last place of the largest
# coordinate.
DIFFERENCE_ERROR = 8.0
# Of the integral of κ² over a surface: a smaller one is rounding error.
FLAT_SURFACE = 1e-9
# Of distances on a surface, relative to its size.
LENGTH_ERROR = 1e-15
# Of a principal radius relative to its terms: 64 ε. A smaller one is zero.
RADIUS_ERROR = 2.0**-46
# Of R Rᵀ − 1 of a rotation: the rounding of its entries and of a few products of rotations.
ROTATION_ERROR = 1e-12
# Parameters that differ by less than this part of their range are the same.
SAME_PARAMETER = 1e-12
# Of triple products of unit vectors: 4 ε. Regions of the sphere are closed up to this.
TRIPLE_PRODUCT_ERROR = 2.0**-50
# Of the normal of a sample on a surface, as an angle (radians).
NORMAL_ERROR = 1e-12
# Of the same angle where Newton's method stagnates because of the rounding of parameters and
# derivatives, or of the error of finite differences: a sample with a larger error is not on the
# surface.
NORMAL_NOISE = 1e-9
# Of the distance at which two samples of one normal coincide on the surface, relative to a cell of
# the spline: the error of points found with numerical derivatives, far from the origin.
MEETING = 2.0**-13
