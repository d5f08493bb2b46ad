"""A peer: another way to get points with normals; and the comparison of its time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from statistics import median
from time import perf_counter
from typing import TypeVar

from .forms import Array, ClosedForm

Result = TypeVar("Result")
Points = tuple[Array, Array]  # and normals, each (N, 3)
Work = Callable[[], Points]

NEAR_ENOUGH = 0.02
TRIES = 6
TUNED_AT = 10_000


@dataclass(frozen=True)
class Peer:
    """One way to points with normals.

    `prepare(form, count)` does all that need not be repeated for further points of a surface (a
    mesh, a model, the search for the setting that gives `count`), and returns the work that is
    timed. In each of `rounds` rounds, `count` points are requested. `density` says whether their
    density follows curvature.
    """

    title: str
    density: str
    module: str
    prepare: Callable[[ClosedForm, int], Work]
    count: int
    rounds: int = 3
    on_net: bool = False  # whether both the peer and gaussmap sample the B-spline

    @property
    def missing(self) -> str:
        """The reason why the peer cannot be used here; empty if it can."""
        try:
            import_module(self.module)
        except (ImportError, OSError) as error:
            return str(error).splitlines()[0]
        return ""


@dataclass(frozen=True)
class Turns:
    """The median seconds of work, the number of its points, and `times`.

    `times` are the ratios of the time of the work to the times of others: medians over the rounds.
    """

    seconds: float
    points: int
    times: Mapping[str, float]


def in_turns(work: Work, others: Mapping[str, Callable[[], object]], rounds: int) -> Turns:
    """Time work and others right after each other, `rounds` times.

    The machine's speed drifts; a ratio of two times that follow each other does not.
    """
    own: list[float] = []
    taken: dict[str, list[float]] = {name: [] for name in others}
    points = 0
    for _ in range(rounds):
        for name, other in others.items():
            seconds, result = timed(other)
            del result  # now, not inside the next time
            taken[name].append(seconds)
        seconds, (found, _) = timed(work)
        points = len(found)
        own.append(seconds)
    ratios = {
        name: median(mine / other for mine, other in zip(own, times, strict=True))
        for name, times in taken.items()
    }
    return Turns(median(own), points, ratios)


def tuned(points_of: Callable[[float], Points], knob: float, count: int, power: float) -> float:
    """Return the setting that gives about `count` points, if their number grows as knob^power.

    The setting is searched with at most TUNED_AT points, since larger meshes take long.
    """
    goal = min(count, TUNED_AT)
    for _ in range(TRIES):
        came = len(points_of(knob)[0])
        knob *= (goal / came) ** (1.0 / power)
        if abs(came / goal - 1.0) < NEAR_ENOUGH:
            break
    return knob * (count / goal) ** (1.0 / power)


def timed(work: Callable[[], Result]) -> tuple[float, Result]:
    """Return the seconds that work takes, and its result."""
    start = perf_counter()
    result = work()
    return perf_counter() - start, result
