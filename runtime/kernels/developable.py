"""Which patches are developable, up to rounding."""

from __future__ import annotations

from ...generated.patch import forms, parabolic_cubic, tangents
from .cone import write_control_normals
from .jit import jit, loop
from .patch import patch_vectors, place_of
from .vectors import largest_component, length, row_vector

__all__ = ["all_developable", "is_developable"]


@loop
def is_developable(patch, net, noise):
    """Say whether the Gaussian curvature of a patch is nothing but rounding of its coordinates.

    `net` (6, 3) are its control normals, `noise` the rounding of the coordinates, in their unit.
    """
    second = max(largest_component(patch.a), largest_component(patch.b), largest_component(patch.c))
    tangent = second + max(largest_component(patch.d), largest_component(patch.e))
    longest = 0.0
    for k in range(6):
        longest = max(longest, length(row_vector(net, k)))
    flat = 4.0 * noise * second * longest * (longest + tangent * second)
    third = 1.0 / 3.0
    _, _, N = tangents(patch, third, third)
    D, _, _, _ = forms(patch, N)
    if abs(D) > flat:  # already at the centre
        return False
    curvature = 0.0
    for value in parabolic_cubic(patch):
        curvature = max(curvature, abs(value))
    return curvature <= flat


@jit
def all_developable(mu, scale, noise, net):
    """Say whether all patches are developable; `net` (6, 3) is memory. See `is_developable`."""
    columns = mu.shape[1] - 2
    for number in range(4 * (mu.shape[0] - 2) * columns):
        i, j, turn = place_of(number, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        write_control_normals(patch, net)
        if not is_developable(patch, net, noise):
            return False
    return True
