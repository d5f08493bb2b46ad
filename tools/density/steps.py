"""The steps of a graded grid: distances between its lines that give the same error everywhere.

A cell with the steps a along u and b along v has a diagonal of the length

    √(e a² + 2 |f| a b + g b²)    and    √(E a² + 2 |F| a b + G b²)

in normal space and in space, where e, f, g are the entries of the third fundamental form, and E, F,
G the entries of the first. Lines u = const have the steps a(u), lines v = const the steps b(v).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...runtime.base.aliases import Array
from .kernels.steps import shared_steps

_Arrays = tuple[Array, Array, Array, Array, float]

# Steps along u are a share of the longest ones that the limits allow. The share is the best one of
# SHARES, refined in SEARCHES steps of golden-section search, for the forms on at most COARSE blocks
# along u and v.
SHARES, SEARCHES, COARSE = np.linspace(0.15, 0.95, 7), 4, 24
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
# The longest and the shortest step, as parts of the domain.
LONGEST, SHORTEST = 0.5, 1e-9
# The angle at which a grid has a given count of samples is searched below WIDEST, in at most TRIALS
# trials, until the relative error of the count is below CLOSE.
WIDEST, CLOSE, TRIALS = math.pi, 0.002, 12
# If a grid for the requested distance, without regard to the angle, has more than 1/LARGER times
# the requested count of samples, the distance is increased until the grid has about 1/LARGER times
# the count.
LARGER = 1.1


@dataclass(frozen=True, eq=False)
class Forms:
    """The third and first fundamental forms (3, k, l) on a raster, and widths (k,) and (l,).

    The forms are evaluated at the midpoints of k × l rectangles, which have these widths along u
    and v.
    """

    third: Array
    first: Array
    widths: tuple[Array, Array]

    def coarser(self, number: int) -> Forms:
        """Return forms on blocks of rectangles, at most `number` blocks along u and along v.

        Each entry of a form becomes the largest modulus of this entry in the block.
        """
        third, first, widths = self.third, self.first, list(self.widths)
        for axis in (0, 1):
            count = len(widths[axis])
            if count > number:
                starts = np.arange(number) * count // number
                third, first = (
                    np.maximum.reduceat(np.abs(x), starts, axis=axis + 1) for x in (third, first)
                )
                widths[axis] = np.add.reduceat(widths[axis], starts)
        return Forms(third, first, (widths[0], widths[1]))

    @cached_property
    def swapped(self) -> Forms:
        """The same forms with u and v exchanged."""
        third, first = (
            np.ascontiguousarray(x[::-1].transpose(0, 2, 1)) for x in (self.third, self.first)
        )
        return Forms(third, first, (self.widths[1], self.widths[0]))

    @cached_property
    def arrays(self) -> tuple[_Arrays, _Arrays]:
        """Two arguments of `shared_steps`: the forms, and the forms with u and v exchanged."""
        along_u, along_v = (
            (x.third, x.first, x.third[0].max(axis=1), x.first[0].max(axis=1), x.widths[0].sum())
            for x in (self, self.swapped)
        )
        return along_u, along_v


@dataclass(frozen=True, eq=False)
class Steps:
    """The steps of a grid `along` u (k,) and v (l,), with the numbers of steps and the errors.

    `lengths` are the numbers of steps along u and v. `angle` and `distance` are half the longest
    diagonals of cells in normal space and in space.
    """

    along: tuple[Array, Array]
    lengths: tuple[float, float]
    angle: float
    distance: float

    @property
    def count(self) -> float:
        """The number of samples of the grid, as a real number."""
        return self.lengths[0] * self.lengths[1]


def equal_steps(forms: Forms, angle: float, distance: float) -> Steps:
    """Return the steps that give the fewest samples.

    Half the diagonals of cells are at most `angle`, in radians, in normal space, and at most
    `distance` in space.
    """
    limits, coarse = ((2.0 * angle) ** 2, (2.0 * distance) ** 2), forms.coarser(COARSE)
    share = _least(lambda x: _steps(coarse, limits, x).count)
    return _steps(forms, limits, share)


def steps_for_count(forms: Forms, count: float, distance: float) -> Steps:
    """Return the steps of a grid with `count` samples, with the smallest angle.

    Half the diagonals of cells are at most `distance` in space. A distance for which the count does
    not suffice is increased; see `LARGER`.
    """
    coarse = forms.coarser(COARSE)
    fewest = equal_steps(coarse, WIDEST, distance).count
    if fewest * LARGER > count:
        distance *= math.sqrt(LARGER * fewest / count)
    guess = [math.sqrt(_typical(coarse) / count)]

    def angle(share: float) -> float:
        steps, guess[0] = _steps_at_share(coarse, share, count, distance, guess[0])
        return guess[0] * max(steps.count / count, 1.0)

    share = _least(angle)
    return _steps_at_share(forms, share, count, distance, angle(share))[0]


def _least(value: Callable[[float], float]) -> float:
    """Return the share at which a function is smallest: the best one of SHARES, refined."""
    values = [value(float(x)) for x in SHARES]
    best = int(np.argmin(values))
    low, high = (float(SHARES[min(max(k, 0), len(SHARES) - 1)]) for k in (best - 1, best + 1))
    places = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
    found = [value(x) for x in places]
    for _ in range(SEARCHES):
        k = int(found[0] < found[1])
        # Drop the part beyond the worse point, and take a new point in the remaining interval.
        low, high = (low, places[1]) if k else (places[0], high)
        places[k], found[k] = places[1 - k], found[1 - k]
        new = high - GOLDEN * (high - low) if k else low + GOLDEN * (high - low)
        places[1 - k], found[1 - k] = new, value(new)
    k = int(np.argmin(found))
    return places[k] if found[k] < values[best] else float(SHARES[best])


def _steps_at_share(
    forms: Forms, share: float, count: float, distance: float, angle: float
) -> tuple[Steps, float]:
    """Return the steps for a share (see SHARES) and a count of samples, and their angle.

    The search for the angle begins at `angle`.
    """

    def steps_at(angle: float) -> Steps:
        return _steps(forms, ((2.0 * angle) ** 2, (2.0 * distance) ** 2), share)

    low, high = 0.0, WIDEST
    steps = steps_at(angle)
    for _ in range(TRIALS):
        ratio = steps.count / count
        if abs(ratio - 1.0) < CLOSE or high - low < CLOSE * high:
            break
        low, high = (angle, high) if ratio > 1.0 else (low, angle)
        # The count is about a power of the angle with an exponent between −2 and 0.
        angle *= ratio if ratio > 1.0 else math.sqrt(ratio)
        if not low < angle < high:
            angle = math.sqrt(low * high) if low > 0.0 else high / 2.0
        steps = steps_at(angle)
    return steps, angle


def _typical(forms: Forms) -> float:
    """Return an estimate of n a², where n is the number of samples of a grid and a its angle."""
    u, v = (np.sqrt(forms.third[k].max(axis=1 - k // 2)) for k in (0, 2))
    lengths = (u * forms.widths[0]).sum() * (v * forms.widths[1]).sum()
    return max(float(lengths) / 2.0, 1e-9)


def _steps(forms: Forms, limits: tuple[float, float], share: float) -> Steps:
    """Return the steps for limits of the squared diagonals in normal space and in space.

    The steps along u are first set to `share` times the longest ones that the limits allow. With
    these, the steps along v are made as long as the limits allow; then the steps along u are made
    as long as the limits allow with these steps along v.
    """
    along = np.empty(len(forms.widths[0])), np.empty(len(forms.widths[1]))
    shared_steps(*forms.arrays, limits, share, SHORTEST, LONGEST, *along)
    lengths = tuple(float((w / x).sum()) for w, x in zip(forms.widths, along, strict=True))
    return Steps(along, (lengths[0], lengths[1]), *(math.sqrt(x) / 2.0 for x in limits))
