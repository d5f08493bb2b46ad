"""Targets for the densities of gaussmap, and whether they are met."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..peers.peer import Peer
from .measure import Found, OnSurface
from .ways import BALANCED, GAUSS, GMSH, PERFECT, POISSON, RELAXED

__all__ = ["CRITERIA", "JUDGED_STEPS", "Criterion", "Verdict", "share", "verdicts", "worst"]

JUDGED_STEPS = 2  # the same for all surfaces
Measure = Callable[[Found, Found], float]


@dataclass(frozen=True)
class Criterion:
    """A ratio of a quantity of `own` to that of `other`; it is met up to `limit`.

    With `at_least`, from `limit` on. A `goal` is to be approached, not met.
    """

    title: str
    own: Peer
    other: Peer
    ratio: Measure
    limit: float
    strict: bool = False
    at_least: bool = False
    goal: bool = False

    def met(self, value: float) -> bool:
        """Whether a ratio is good enough."""
        if self.at_least:
            return value >= self.limit
        return value < self.limit if self.strict else value <= self.limit

    @property
    def target(self) -> str:
        """The limit in words."""
        sign = "≥" if self.at_least else "<" if self.strict else "≤"
        return f"{sign} {self.limit:g}"


@dataclass(frozen=True)
class Verdict:
    """A criterion on one surface at one count."""

    criterion: Criterion
    on: OnSurface
    count: int
    value: float | None  # None if the other one is missing

    @property
    def met(self) -> bool | None:
        """Whether it is met; None if that is not known."""
        return None if self.value is None else self.criterion.met(self.value)


def of_E(own: Found, other: Found) -> float:
    """E over E."""
    return own.E / other.E


def of_G(own: Found, other: Found) -> float:
    """G over G."""
    return own.G / other.G


def speed(own: Found, other: Found) -> float:
    """The ratio of points per second; `own` is balanced, and was timed in turns with `other`."""
    return other.times


def _criteria() -> Iterator[Criterion]:
    relaxed = RELAXED[JUDGED_STEPS - 1]
    yield Criterion("gauss : exact, G", GAUSS, PERFECT, of_G, 1.05)
    yield Criterion("relaxed : Gmsh, G", relaxed, GMSH, of_G, 1.0, strict=True)
    yield Criterion("relaxed : Gmsh, E", relaxed, GMSH, of_E, 1.15)
    yield Criterion("goal: relaxed : Gmsh, E", relaxed, GMSH, of_E, 1.0, strict=True, goal=True)
    for peer in POISSON:
        name = peer.title.partition(",")[0]
        yield Criterion(f"balanced : {name}, E", BALANCED, peer, of_E, 1.0)
        yield Criterion(f"balanced : {name}, G", BALANCED, peer, of_G, 1.0, strict=True)
        yield Criterion(f"balanced : {name}, speed", BALANCED, peer, speed, 20.0, at_least=True)


CRITERIA = tuple(_criteria())


def verdicts(criterion: Criterion, on: OnSurface, counts: tuple[int, ...]) -> list[Verdict]:
    """Judge one surface."""
    result = []
    for count in counts:
        both = [on.found.get((way, count)) for way in (criterion.own, criterion.other)]
        own, other = both
        value = None if own is None or other is None else criterion.ratio(own, other)
        result.append(Verdict(criterion, on, count, value))
    return result


def worst(found: list[Verdict]) -> Verdict:
    """Return the verdict that is farthest from being met; one without a value if all are."""
    known = [x for x in found if x.value is not None]
    sign = -1.0 if found[0].criterion.at_least else 1.0
    return max(known, key=lambda x: sign * (x.value or 0.0), default=found[0])


def share(found: list[Verdict]) -> str:
    """Return how many of the known verdicts are met, such as "3 of 4"."""
    known = [x.met for x in found if x.met is not None]
    return f"{sum(known)} of {len(known)}"
