"""Which patches are developable, up to rounding.

A test at the centre of a patch excludes most patches. The full test, which takes much longer to
compile, is a kernel of its own.
"""

from __future__ import annotations

from ...generated.patch import forms, parabolic_cubic
from .cone import write_control_normals
from .jit import jit, loop
from .patch import normal_of_patch, patch_vectors, place_of
from .vectors import largest_component, length, row_vector

__all__ = ["count_developable", "first_curved", "may_be_developable"]

THIRD = 1.0 / 3.0


@loop
def curvature_error(patch, net, noise):
    """Return the error of D(N), which has the sign of K, due to the rounding of coordinates.

    `net` (6, 3) are the control normals of the patch, `noise` is the rounding, in its unit.
    """
    second = max(largest_component(patch.a), largest_component(patch.b), largest_component(patch.c))
    tangent = second + max(largest_component(patch.d), largest_component(patch.e))
    longest = 0.0
    for k in range(6):
        longest = max(longest, length(row_vector(net, k)))
    return 4.0 * noise * second * longest * (longest + tangent * second)


@loop
def may_be_developable(patch, net, noise):
    """Return whether the Gaussian curvature at the centre of a patch is zero up to rounding."""
    D, _, _, _ = forms(patch, normal_of_patch(patch, THIRD, THIRD))
    return not abs(D) > curvature_error(patch, net, noise)


@jit
def first_curved(mu, scale, noise, net):
    """Return the first patch that is curved at its centre, or the number of patches.

    `net` (6, 3) is a work array.
    """
    columns = mu.shape[1] - 2
    count = 4 * (mu.shape[0] - 2) * columns
    for number in range(count):
        i, j, turn = place_of(number, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        write_control_normals(patch, net)
        if not may_be_developable(patch, net, noise):
            return number
    return count


@jit
def count_developable(mu, scale, noise, patches, net):
    """Return the number of patches (k,) that are developable; `net` (6, 3) is a work array."""
    columns = mu.shape[1] - 2
    found = 0
    for k in range(patches.size):
        i, j, turn = place_of(patches[k], columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        write_control_normals(patch, net)
        largest = 0.0
        for value in parabolic_cubic(patch):
            largest = max(largest, abs(value))
        found += largest <= curvature_error(patch, net, noise)
    return found
