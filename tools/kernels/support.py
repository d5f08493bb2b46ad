"""Support functions: the branches of patches at given normals, offsets, and curvatures.

A branch is one patch at one of its normals: the point, the Hessian of the support function, and the
curvatures.
"""

from __future__ import annotations

import math

from ...generated import support_function
from ...generated.patch import forms, parameters, tangents
from ...generated.spline import SCALE
from ...generated.support import (
    curvature_from_hessian,
    hessian_at,
    offset,
    offset_curvature,
    offset_growth,
    parameters_at,
)
from ...generated.vectors import Hessian, Vector
from ...runtime.kernels.patch import patch_vectors, place_of
from ...runtime.kernels.vectors import dot, length, row_vector
from ...runtime.machine_code.jit import inline, jit

__all__ = [
    "DOUBTFUL",
    "INSIDE",
    "OUTSIDE",
    "add_offset",
    "branches_of_patch",
    "classify",
    "curvatures_from_hessians",
    "hessians_of_patches",
    "offset_curvatures",
    "support_values",
]

OUTSIDE = 0
INSIDE = 1
DOUBTFUL = 2
# A sum that is smaller than its terms by this factor suffers from cancellation.
CANCELLED = math.ldexp(1.0, -20)


# --- patches --------------------------------------------------------------------------------------

# (patch, normals, u_values, v_values, points, hessians, K_values, H_values)
branches_of_patch = jit(support_function.branch)


@jit
def classify(patch, bound, accurate, shortest, normals, kinds, uv):
    """Write the kinds of the normals (k, 3) relative to a patch, and u, v (k, 2) if INSIDE.

    `bound` is the rounding error of U, V, W. D must exceed `accurate`, and N `shortest`. Normals
    have a length of about 1. Normals undecided because of rounding are DOUBTFUL.
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

    known (k, 2) are u, v where they are more accurate than from the normal, which is then that of
    the patch at u, v; else NaN.
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


# --- any support function -------------------------------------------------------------------------

# (normals, points, h_values)
support_values = jit(support_function.tangent_plane)


@inline
def size_of_terms(K, H, R):
    """Return the sum of the moduli of the terms of s = 1 + 2 R H + R² K."""
    return 1.0 + 2.0 * abs(R * H) + abs(R * R * K)


@jit
def add_offset(R, normals, points, hessians, gaussian, mean, doubtful):
    """Add a sphere of radius R to points and Hessians at unit normals (k, 3), change curvatures.

    Where a radius of curvature was about 0, or becomes so, these are `doubtful` (k,).
    """
    for k in range(normals.shape[0]):
        x, H = offset(R, row_vector(normals, k))
        points[k, 0] += x.x
        points[k, 1] += x.y
        points[k, 2] += x.z
        hessians[k, 0, 0] += H.H_xx
        hessians[k, 1, 1] += H.H_yy
        hessians[k, 2, 2] += H.H_zz
        hessians[k, 0, 1] += H.H_xy
        hessians[k, 1, 0] += H.H_xy
        hessians[k, 0, 2] += H.H_xz
        hessians[k, 2, 0] += H.H_xz
        hessians[k, 1, 2] += H.H_yz
        hessians[k, 2, 1] += H.H_yz
        terms = size_of_terms(gaussian[k], mean[k], R)
        s, K_offset, H_offset = offset_curvature(gaussian[k], mean[k], R)
        gaussian[k] = K_offset
        mean[k] = H_offset
        doubtful[k] = not abs(s) > CANCELLED * terms


@jit
def offset_curvatures(R, rounding, gaussian, mean, folded):
    """Change the curvatures (k,) to those of the offset, and write where R has passed a radius.

    Where a radius becomes 0, up to the `rounding` of the sum that says so, Gaussian curvature is
    infinite with its old sign (NaN if it was 0) and mean curvature NaN.
    """
    for k in range(gaussian.size):
        K = gaussian[k]
        H = mean[k]
        _, K_offset, H_offset = offset_curvature(K, H, R)
        s, m = offset_growth(K, H, R)
        terms = size_of_terms(K, H, R)
        vanishing = terms < math.inf and abs(s) <= rounding * terms
        gaussian[k] = K * math.inf if vanishing else K_offset
        mean[k] = math.nan if vanishing else H_offset
        folded[k] = vanishing or s < 0.0 or m < 0.0


@jit
def curvatures_from_hessians(normals, hessians, radii, gaussian, mean):
    """Write principal radii (k, 2), the larger one first, and curvatures (k,).

    hessians (k, 3, 3) are those of the support function at unit normals (k, 3).
    """
    for k in range(normals.shape[0]):
        hessian = Hessian(
            hessians[k, 0, 0],
            hessians[k, 1, 1],
            hessians[k, 2, 2],
            hessians[k, 0, 1],
            hessians[k, 0, 2],
            hessians[k, 1, 2],
        )
        m, _, S, K, H = curvature_from_hessian(row_vector(normals, k), hessian)
        radii[k, 0] = m + math.sqrt(S)
        radii[k, 1] = m - math.sqrt(S)
        gaussian[k] = K
        mean[k] = H
