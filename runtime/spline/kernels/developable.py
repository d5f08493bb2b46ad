"""Which patches are developable, up to rounding.

A test at the centre of a patch excludes most patches.
"""

from __future__ import annotations

import math

from ....generated.patch import control_normals, forms, parabolic_cubic
from ...directions.kernels.vectors import dot, largest_component
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import jit, loop
from .patch import normal_of_patch, patch_vectors

__all__ = ["count_developable"]

THIRD = 1.0 / 3.0


@loop
def curvature_error(patch, longest, noise):
    """Return the error of D(N), which has the sign of K, due to the rounding of coordinates.

    `longest` is the length of the longest control normal, `noise` the rounding, in their units.
    """
    second = max(largest_component(patch.a), largest_component(patch.b), largest_component(patch.c))
    tangent = second + max(largest_component(patch.d), largest_component(patch.e))
    return 4.0 * noise * second * longest * (longest + tangent * second)


@loop
def may_be_developable(patch, longest, noise):
    """Return whether the Gaussian curvature at the centre of a patch is zero up to rounding."""
    D, _, _, _ = forms(patch, normal_of_patch(patch, THIRD, THIRD))
    return not abs(D) > curvature_error(patch, longest, noise)


@loop
def longest_control_normal(patch):
    """Return the length of the longest control normal of a patch."""
    longest = 0.0
    for normal in control_normals(patch):
        longest = max(longest, dot(normal, normal))
    return math.sqrt(longest)


@jit
def count_developable(mu, scale, noise, first, last):
    """Return how many of the patches first, …, last − 1 are developable."""
    columns = mu.shape[1] - 2
    found = 0
    for number in range(first, last):
        i, j, turn = place_of(number, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        longest = longest_control_normal(patch)
        if may_be_developable(patch, longest, noise):
            found += is_developable(patch, curvature_error(patch, longest, noise))
    return found


@loop
def is_developable(patch, error):
    """Return whether the parabolic cubic of a patch is zero up to an error."""
    largest = 0.0
    for value in parabolic_cubic(patch):
        largest = max(largest, abs(value))
    return largest <= error
