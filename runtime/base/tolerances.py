"""Bounds of rounding errors and thresholds derived from them, each with its unit and its reason.

NumPy code and kernels read the same numbers. ε = 2⁻⁵² is the distance from 1 to the next float64. A
comment says which quantity the bound is for.
"""

from __future__ import annotations

# The error of coordinates, relative to the largest coordinate: a few roundings, at most 64 ε.
DATA_ERROR = 2.0**-46
# The error of the linear forms A, B, C, P, Q at a unit normal, relative to the largest difference
# of the coefficients of a patch: the integer weights of a vector sum to at most 12 in modulus, and
# a scalar product adds three roundings, so that 2⁻⁴³ leaves a factor of 6 to spare.
FORM_ERROR = 2.0**-43
# The quadratic forms U, V, W of a patch are compared with a bound of their errors. The form D has
# to exceed this bound by the factor ACCURATE, so that u = U/D and v = V/D have about 16 correct
# bits.
ACCURATE = 2.0**16
# The error of the direction of a control normal, an angle in radians: at most this times 1 + t²/l,
# with the length t of the tangents and the length l of the control normal.
ANGLE_ERROR = 2.0**-40
# A control normal shorter than this, relative to the square of the tangents, has no direction: its
# patch has a singular point there. The threshold is far above the rounding error of a cross
# product.
SHORT_CONTROL_NORMAL = 2.0**-30
# A point counts as singular where the normal is shorter than this, relative to the normal at the
# centre of its patch. The curvatures of a singular point are evaluated at another point, which is
# nearer to the centre of the patch by about this distance in u, v.
SINGULAR_POINT = 2.0**-20
# A point counts as near a singular point where the normal is shorter than this, relative to the
# square of the tangents: the direction of the normal there needs parameters with many digits.
NEAR_SINGULAR_POINT = 2.0**-12
# A normal counts as zero if it is shorter than this, relative to the product or the square of the
# tangents or to the largest normal of the patch, and so does the slope of a linear function,
# relative to the tangents: 4096 ε, far above the rounding of such products.
VANISHING = 2.0**-40
# The error of a coefficient of the parabolic cubic, or of the cubic whose roots are directions of
# parabolic lines, relative to the product of the lengths of the vectors in its terms: 256 ε.
CUBIC_ERROR = 2.0**-44
# The error of parameters in the triangle u, v, 1 − u − v ≥ 0, whose legs have length 1.
PARAMETER_ERROR = 1e-12
# Two roots, directions (radians) or parameter pairs (u, v) that differ by less than this count as a
# double root, and an imaginary part smaller than this counts as zero: a rounding error ε splits a
# double root by √ε ≈ 1.5e-8, times the condition number of the cubic, for which a factor of 67 is
# left.
DOUBLE_ROOT = 1e-6
# The iteration for the smallest cap has converged if its radius grows by less than this, in
# degrees.
CAP_RADIUS_ERROR = 1e-12
# The error of the height z of points on a circle of latitude of the unit sphere. A point counts as
# on the circle if its height differs from that of the circle by at most this.
CIRCLE_HEIGHT_ERROR = 1e-12
# The flip or collapse of an edge must raise a quality of triangles (a cosine, or the tangent of an
# angle) by at least this, which exceeds the rounding error of the quality.
QUALITY_GAIN = 1e-14
# A triangle whose smallest angle (radians) is below this counts as a triangle without area: its
# area vanishes in files of single precision.
NO_AREA = 1e-6
# The error of K, of H and of 1 + 2 d H + d² K for an offset by d, relative to the terms of these
# sums, in units of the last place.
CURVATURE_ERROR = 4.0
# The error of a principal curvature times the diagonal of the bounding box, relative to the
# rounding of coordinates in units of the diagonal. DERIVATIVE_ERROR is for surfaces that are given
# by values only, whose curvatures come from second differences; PATCH_ERROR is for splines, and is
# multiplied by the square of the number of cells. Measured values on planes, cylinders and cones
# are 1.3e7 and 40.
DERIVATIVE_ERROR, PATCH_ERROR = 2.0**26, 2.0**8
# The error of a difference of two coefficients of a planar spline, in units of the last place of
# the largest coordinate.
DIFFERENCE_ERROR = 8.0
# The error of the integral of κ² over a surface. It replaces a smaller integral.
FLAT_SURFACE = 1e-9
# The error of distances on a surface, relative to its size.
LENGTH_ERROR = 1e-15
# The error of a principal radius relative to its terms: 64 ε. A smaller radius counts as zero.
RADIUS_ERROR = 2.0**-46
# The error of R Rᵀ − 1 for a rotation R: the rounding of its entries and of a few products of
# rotations.
ROTATION_ERROR = 1e-12
# Parameters that differ by less than this part of their range count as equal.
SAME_PARAMETER = 1e-12
# The error of triple products of unit vectors: 4 ε. Regions of the sphere are enlarged by this, so
# that their boundaries belong to them.
TRIPLE_PRODUCT_ERROR = 2.0**-50
# The error of the normal of a sample on a surface, an angle in radians.
NORMAL_ERROR = 1e-12
# The largest error of the normal of a sample, in radians, where Newton's method stagnates because
# of the rounding of parameters and derivatives, or of the error of finite differences: a sample
# with a larger error is not on the surface.
NORMAL_NOISE = 1e-9
# Two samples with the same normal are the same point of the surface if their distances in space and
# in the parameters, relative to a cell of the spline, are at most this: the error of points that
# are found with numerical derivatives on a surface far from the origin.
MEETING = 2.0**-13
