"""The longest steps of a graded grid along one parameter, for given steps along the other one."""

from __future__ import annotations

import math

from .jit import inline, jit

__all__ = ["longest_steps"]


@inline
def longest_step(e, f, g, a, limit):
    """Return the largest b with e a² + 2 |f| a b + g b² ≤ limit, 0 if there is none."""
    left = limit - e * a * a
    if left <= 0.0:
        return 0.0
    mixed = abs(f) * a
    below = mixed + math.sqrt(mixed * mixed + g * left)
    return left / below if below > 0.0 else math.inf


@jit
def longest_steps(third, first, limits, along, most, steps):
    """Write the longest steps (l,) along v for steps (k,) along u, `most` at most.

    `third` and `first` (3, k, l) are two forms with a limit each.
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
