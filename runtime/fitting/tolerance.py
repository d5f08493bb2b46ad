"""The numbers of cells of a spline, along u and along v, for a tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from ..base.checks import positive_number
from ..base.errors import InputError
from ..base.tolerances import DATA_ERROR
from ..spline.spline import Spline
from .comparison import Comparison, Misfit

# A spline is an improvement if at most this part of an error remains. Halving the cells leaves an
# eighth of an error of order 3, and a half of an error of order 1, as at creases.
IMPROVED = 0.75
# Cells are halved along u only if the error varies more than this many times as much along u as
# along v, along v only in the opposite case, and along both otherwise.
DOMINANT = 4.0
# The smallest angle that is measured, in degrees.
LEAST_ANGLE = 1e-4
# The relative tolerance of positions if only a tolerance of normals is given.
BESIDE_NORMALS = 1e-4
# A spline whose distance exceeds the goal by this factor may miss a feature of the surface, and the
# search goes on.
FAR_OFF = 10.0


@dataclass(frozen=True)
class Tolerance:
    """The largest errors that a spline may have, and bounds of the search for enough cells.

    The errors are a `distance` in L, or a `relative` one in units of the diagonal of the bounding
    box, and an `angle` between normals in degrees. With `poles`, angles next to poles and other
    collapsed sides count as well. There are at most `most` cells along u and along v, and `total`
    cells in all. The search ends after `patience` steps without improvement, unless the distance is
    far from the goal.
    """

    distance: float | None
    relative: float | None
    angle: float | None
    poles: bool = True
    most: tuple[int, int] = (4096, 4096)
    total: int = 2**20
    patience: int = 9

    def of_size(self, diagonal: float, largest: float) -> Tolerance:
        """Return the tolerance for a surface with this diagonal and this largest coordinate.

        Raises InputError if its distance is below the rounding of the coordinates.
        """
        asked = self.distance if self.relative is None else self.relative * diagonal
        least = DATA_ERROR * largest
        if asked is not None and asked < least:
            raise InputError(
                f"a tolerance of {asked:.3g} is below the rounding of coordinates as large as "
                f"{largest:.3g}; choose at least {least:.1g}."
            )
        return replace(self, distance=asked)

    def excess(self, comparison: Comparison) -> tuple[float, float]:
        """Return the distance and the angle of a misfit, divided by the largest allowed ones."""
        misfit = comparison.misfit
        angle = misfit.angle if self.poles else comparison.angle_away
        return (
            0.0 if self.distance is None else misfit.distance / self.distance,
            0.0 if self.angle is None or angle is None else angle / self.angle,
        )

    def reached(self, comparison: Comparison) -> bool:
        """Return whether a spline is as accurate as requested."""
        return max(self.excess(comparison)) <= 1.0


def checked_tolerance(
    cells: object, distance: object, relative: object, angle: object
) -> Tolerance | None:
    """Return the tolerance from the arguments of `fit`, or None; InputError if it is invalid."""
    given = {
        name: positive_number(value, name, unit, most)
        for name, value, unit, most in (
            ("tolerance", distance, "", math.inf),
            ("relative_tolerance", relative, "", 1.0),
            ("normal_tolerance", angle, " degrees", 90.0),
        )
        if value is not None
    }
    if not given:
        return None
    if cells is not None:
        raise InputError(f"cells and {next(iter(given))} do not go together: choose one.")
    if "tolerance" in given and "relative_tolerance" in given:
        raise InputError("tolerance and relative_tolerance do not go together: choose one.")
    if given.get("normal_tolerance", math.inf) < LEAST_ANGLE:
        raise InputError(
            f"normal_tolerance must be at least {LEAST_ANGLE:g} degrees: normals are compared with "
            "that accuracy."
        )
    if [*given] == ["normal_tolerance"]:
        given["relative_tolerance"] = BESIDE_NORMALS
    return Tolerance(
        given.get("tolerance"), given.get("relative_tolerance"), given.get("normal_tolerance")
    )


def refined(
    fitted: Callable[[tuple[int, int]], Spline],
    compare: Callable[[Spline], Comparison],
    variation: Callable[[Spline, Comparison, bool], tuple[float, float]],
    spline: Spline,
    goal: Tolerance,
) -> tuple[Spline, Misfit, bool]:
    """Return a spline with enough cells for a goal, its misfit, and whether the goal is reached.

    The cells of `spline` are halved along u, along v or along both, depending on the `variation` of
    the error along u and along v. If the goal is not reached, the result is the last spline that
    was an improvement.
    """
    stalled, comparison = 0, compare(spline)
    best, its_comparison = spline, comparison
    while not goal.reached(comparison):
        distance, angle = goal.excess(comparison)
        if stalled >= goal.patience and distance <= FAR_OFF:
            break
        # The variation may mislead: the error also varies along u if cells are too long along v.
        # After a step without improvement, the variation of the distance is therefore used.
        u, v = variation(spline, comparison, angle > distance and stalled == 0)
        finer = _finer(spline.cells, u, v, goal)
        if finer == spline.cells:
            break
        spline = fitted(finer)
        comparison = compare(spline)
        if goal.reached(comparison) or _improved(goal, its_comparison, comparison):
            best, its_comparison, stalled = spline, comparison, 0
        else:
            stalled += 1
    return best, its_comparison.misfit, goal.reached(its_comparison)


def _improved(goal: Tolerance, before: Comparison, after: Comparison) -> bool:
    """Return whether an error above the goal is at most IMPROVED times its earlier value."""
    pairs = zip(goal.excess(before), goal.excess(after), strict=True)
    return any(old > 1.0 and new <= IMPROVED * old for old, new in pairs)


def _finer(cells: tuple[int, int], u: float, v: float, goal: Tolerance) -> tuple[int, int]:
    """Return the numbers of cells, doubled along u, along v or along both, within the bounds.

    `u` and `v` are the variations of the error along u and along v.
    """
    twice = [min(2 * count, most) for count, most in zip(cells, goal.most, strict=True)]
    along_u, along_v = (twice[0], cells[1]), (cells[0], twice[1])
    larger, smaller = (along_u, along_v) if u >= v else (along_v, along_u)
    both = (twice[0], twice[1])
    choices = [larger, smaller] if max(u, v) > DOMINANT * min(u, v) else [both, larger, smaller]
    fitting = (x for x in choices if x != cells and x[0] * x[1] <= goal.total)
    return next(fitting, cells)
