"""Judging and timing every way on one surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from ..peers.forms import ClosedForm
from ..peers.measure import nearest_by_tree
from ..peers.metrics import Places, both
from ..peers.peer import Peer, Work, in_turns
from .ways import BALANCED, POISSON

__all__ = ["CLOUDS", "COUNTS", "LARGE", "Found", "OnSurface", "measured"]

COUNTS = (2_000, 10_000)
LARGE = 100_000
# The number of random samplings of which E and G are the medians.
CLOUDS = 3
# Methods that would take longer than this many seconds for LARGE points are left out.
FEASIBLE = 8.0  # seconds


@dataclass(frozen=True)
class Found:
    """What a way did for a count: how many points came, E and G, points a second.

    `times` is how many times as fast gaussmap is with density="balanced", timed in turns.
    """

    points: int
    E: float
    G: float
    rate: float
    times: float


@dataclass(frozen=True)
class OnSurface:
    """All that was found on a surface.

    `found` by way and count, `large` as (points/s, times) by way, `missing` says why a way could
    not be tried.
    """

    form: ClosedForm
    found: dict[tuple[Peer, int], Found]
    large: dict[Peer, tuple[float, float]]
    missing: dict[Peer, str]


def measured(form: ClosedForm, ways: tuple[Peer, ...], done: Callable[[str], object]) -> OnSurface:
    """Judge and time all ways; `done` is told each of them."""
    result, places = OnSurface(form, {}, {}, {}), Places.of(form)
    for way in ways:
        done(f"{form.name}: {way.title}")
        if way.missing:
            result.missing[way] = way.missing
            continue
        for count in COUNTS:
            result.found[way, count] = found(form, places, way, count)
        largest = result.found[way, COUNTS[-1]]
        if LARGE / largest.rate <= FEASIBLE:
            _, rate, times = timed_beside_balanced(form, way, way.prepare(form, LARGE), LARGE, 1)
            result.large[way] = rate, times
    return result


def found(form: ClosedForm, places: Places, way: Peer, count: int) -> Found:
    """Judge and time a way."""
    work = way.prepare(form, count)
    clouds = [work() for _ in range(CLOUDS if way in POISSON else 1)]
    errors = [both(form, places, *cloud, nearest_by_tree) for cloud in clouds]
    points, rate, times = timed_beside_balanced(form, way, work, count, way.rounds)
    E, G = (median(x) for x in zip(*errors, strict=True))
    return Found(points, E, G, rate, times)


def timed_beside_balanced(
    form: ClosedForm, way: Peer, work: Work, count: int, rounds: int
) -> tuple[int, float, float]:
    """Return how many points come, points a second, and balanced's rate over that."""
    others = {} if way is BALANCED else {"balanced": BALANCED.prepare(form, count)}
    turns = in_turns(work, others, rounds)
    times = turns.times["balanced"] * count / turns.points if others else 1.0
    return turns.points, turns.points / turns.seconds, times
