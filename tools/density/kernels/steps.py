"""The longest steps of a graded grid along both parameters that the error limits allow."""

from __future__ import annotations

import math

from ....runtime.machine_code.jit import inline, jit, loop

EPS = 2.0**-52


@inline
def longest_step(e, f, g, a, limit):
    """Return the largest b with e a² + 2 |f| a b + g b² ≤ limit; 0 if none exists."""
    left = limit - e * a * a
    if f == 0.0 and g == 0.0:
        return math.inf if left >= -8.0 * EPS * limit else 0.0  # e a² = limit up to rounding
    if left <= 0.0:
        return 0.0
    mixed = abs(f) * a
    below = mixed + math.sqrt(mixed * mixed + g * left)
    return left / below if below > 0.0 else math.inf


@loop
def longest_steps(third, first, limits, along, least, most, steps):
    """Write the longest steps (l,) along v for steps (k,) along u, between `least` and `most`.

    `third` and `first` (3, k, l) are the third and first fundamental forms; `limits` are the
    largest squared diagonals of a cell in normal space and in space.
    """
    limit_of_third, limit_of_first = limits
    for j in range(steps.size):
        steps[j] = most
    for i in range(along.size):
        a = along[i]
        for j in range(steps.size):
            in_normal = longest_step(
                third[0, i, j], third[1, i, j], third[2, i, j], a, limit_of_third
            )
            in_space = longest_step(
                first[0, i, j], first[1, i, j], first[2, i, j], a, limit_of_first
            )
            steps[j] = min(steps[j], in_normal, in_space)
    for j in range(steps.size):
        steps[j] = max(steps[j], least)


@jit
def shared_steps(forms, swapped, limits, share, shortest, longest, along_u, along_v):
    """Write the steps along u (k,) and v (l,) for limits of the squared diagonals of cells.

    The steps along u are first set to `share` times the longest ones that the limits allow. With
    these, the steps along v are made as long as the limits allow; then the steps along u are made
    as long as the limits allow with these steps along v.

    `forms` are the third and the first fundamental form (3, k, l), the maxima (k,) of e and of E
    along v, and the width of the domain; `swapped` are the same with u and v exchanged. Steps are
    at least the part `shortest` of the domain, and at most the part `longest`.
    """
    third, first, largest_of_third, largest_of_first, width = forms
    for i in range(along_u.size):
        in_normal = share * math.sqrt(limits[0] / largest_of_third[i])
        in_space = share * math.sqrt(limits[1] / largest_of_first[i])
        along_u[i] = min(in_normal, in_space, longest * width)
    other, across, _, _, height = swapped
    longest_steps(third, first, limits, along_u, shortest * height, longest * height, along_v)
    longest_steps(other, across, limits, along_v, shortest * width, longest * width, along_u)
