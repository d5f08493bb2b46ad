"""The checked arguments of a sampling: normals, count, angle, coverage and density."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import checked_count, known_name, positive_number
from ...runtime.base.errors import InputError
from ...runtime.base.threads import thread_count
from ...runtime.directions.regions import Reach, checked_reach
from ...runtime.directions.sets import frequency_within, icosphere
from ...runtime.directions.unit import as_normals

# Densities that follow the larger principal curvature.
BY_CURVATURE = ("balanced", "aligned")
DENSITIES = ("gauss", "balanced", "aligned", "uniform")
BALANCED = [[x] for x in ("normals", "count", "angle", "coverage")] + [
    [x, "coverage"] for x in ("normals", "count", "angle")
]
# For larger α, |K|^α is so uneven that all samples crowd around the point of the largest |K|.
LARGEST_POWER = 8.0


@dataclass(frozen=True, eq=False)
class Request:
    """A checked request: one of normals (S, 3), a count, an angle in degrees and a coverage.

    A coverage may also be combined with one of the other three. `density` is one of `DENSITIES`, or
    α for |K|^α. Normals outside of `reach` get no samples.
    """

    normals: NDArray[np.float64] | None
    count: int | None
    angle: float | None
    coverage: float | None
    density: str | float
    reach: Reach | None = None

    @property
    def cost(self) -> str:
        """The key of `memory.COSTS` for the memory that the samples take."""
        return self.density if isinstance(self.density, str) else "uniform"

    @property
    def solid_angle(self) -> float:
        """The solid angle of the normals that may have samples."""
        return 4 * math.pi if self.reach is None else self.reach._smallest.solid_angle

    @property
    def directions(self) -> NDArray[np.float64]:
        """The normals; for an angle, those of an icosphere with at most this covering radius."""
        if self.normals is not None:
            return self.normals
        assert self.angle is not None
        return icosphere(frequency_within(self.angle))


def checked_request(
    normals: ArrayLike | None,
    count: int | None,
    angle: float | None,
    coverage: float | None,
    density: str | float | None,
    threads: int | None,
    reach: Any = None,  # noqa: ANN401
) -> Request:
    """Return a request; InputError (or UnknownNameError) if the arguments are invalid."""
    thread_count(threads)
    number = None if count is None else checked_count(count)
    amounts = {"normals": normals, "count": count, "angle": angle, "coverage": coverage}
    given = [name for name, value in amounts.items() if value is not None]
    if not given or len({*given} - {"coverage"}) > 1:
        raise InputError(
            "say how many samples by one of normals, count, angle and coverage; "
            + (f"{' and '.join(given)} do not go together." if given else "none is given.")
        )
    kind = _density(density, "gauss" if given == ["normals"] else "balanced")
    _check_that_they_fit(kind, given)
    within = checked_reach(reach)
    if within is not None and kind == "aligned":
        raise InputError(
            'density "aligned" is a grid on all of a surface; with a reach use "balanced".'
        )
    return Request(
        None if normals is None else as_normals(normals, threads=threads),
        number,
        None if angle is None else positive_number(angle, "angle", " degrees", most=90.0),
        None if coverage is None else positive_number(coverage, "coverage"),
        kind,
        within,
    )


def _density(density: str | float | None, default: str) -> str | float:
    if density is None:
        return default
    if isinstance(density, str):
        return known_name(density, DENSITIES, "density")
    return positive_number(density, "density, as the power of |K|,", most=LARGEST_POWER)


def _check_that_they_fit(density: str | float, given: list[str]) -> None:
    """Raise InputError for a count, angle or coverage that a density does not support."""
    fitting = {
        # The density "gauss" does not support an angle: next to open boundaries, the normals of
        # samples leave gaps wider than the covering radius of the prescribed normals.
        "gauss": [["normals"], ["count"]],
        "balanced": BALANCED,
        "aligned": [x for x in BALANCED if "normals" not in x],
        "uniform": [["count"], ["coverage"]],
    }.get(str(density), [["count"]])
    if given not in fitting:
        shown = f'"{density}"' if isinstance(density, str) else density
        raise InputError(
            f"density {shown} does not go with {' and '.join(given)}; "
            f"use {' or '.join(x[0] for x in fitting if len(x) == 1)}."
        )
