"""Support functions of patches: classification of normals, and branches at given normals.

A branch is one patch at one of its normals: the point, the Hessian of the support function, and the
curvatures.
"""

from __future__ import annotations

import math

from ....generated import support_function
from ....generated.patch import forms, parameters, tangents
from ....generated.spline import SCALE
from ....generated.support import hessian_at, parameters_at
from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import dot, length, row_vector
from ....runtime.domain.kernels.patch_numbers import place_of
from ....runtime.machine_code.jit import jit
from ....runtime.spline.kernels.patch import patch_vectors

OUTSIDE = 0
INSIDE = 1
DOUBTFUL = 2

# The arguments are (patch, normals, u_values, v_values, points, hessians, K_values, H_values).
branches_of_patch = jit(support_function.branch)


@jit
def classify(patch, bound, accurate, shortest, normals, kinds, uv):
    """Write whether normals (k, 3) are INSIDE or OUTSIDE the image of a patch, and u, v if INSIDE.

    `normals` have a length of about 1, `kinds` (k,) and `uv` (k, 2) are the results. A normal is
    DOUBTFUL if rounding leaves it undecided: `bound` is the rounding error of the forms U, V, W,
    and INSIDE needs |D| > `accurate` and |N| > `shortest`.
    """
    for k in range(normals.shape[0]):
        n = row_vector(normals, k)
        D, U, V, W = forms(patch, n)
        low = min(U, V, W)
        high = max(U, V, W)
        kinds[k] = OUTSIDE
        if low < -bound and high > bound:
            continue
        kinds[k] = DOUBTFUL
        if (low > bound or high < -bound) and abs(D) > accurate:
            u, v = parameters(D, U, V)
            _, _, N = tangents(patch, u, v)
            towards = dot(n, N)
            size = abs(N.x) + abs(N.y) + abs(N.z)
            if abs(towards) > 0.25 * size and size > shortest:
                kinds[k] = INSIDE if towards > 0.0 else OUTSIDE
                uv[k, 0] = u
                uv[k, 1] = v


@jit
def hessians_of_patches(mu, scale, patches, normals, known, hessians):
    """Write the Hessians (k, 3, 3) of the support function at unit normals (k, 3) of patches (k,).

    Where `known` (k, 2) is not NaN, it holds the parameters u, v, which are more accurate than
    parameters computed from the normal. The normal of the patch at u, v then replaces the given
    normal.
    """
    columns = mu.shape[1] - 2
    size = SCALE * scale
    for k in range(patches.size):
        i, j, turn = place_of(patches[k], columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        n = row_vector(normals, k)
        u = known[k, 0]
        v = known[k, 1]
        if math.isnan(u):
            u, v = parameters_at(patch, n)
        else:
            _, _, N = tangents(patch, u, v)
            size_of_N = length(N)
            n = Vector(N.x / size_of_N, N.y / size_of_N, N.z / size_of_N)
        H = hessian_at(patch, n, u, v)
        hessians[k, 0, 0] = H.H_xx / size
        hessians[k, 1, 1] = H.H_yy / size
        hessians[k, 2, 2] = H.H_zz / size
        hessians[k, 0, 1] = hessians[k, 1, 0] = H.H_xy / size
        hessians[k, 0, 2] = hessians[k, 2, 0] = H.H_xz / size
        hessians[k, 1, 2] = hessians[k, 2, 1] = H.H_yz / size
