"""Judging and timing all ways to points, and judging all meshes, on one surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, field
from statistics import median

from ..peers.forms import ClosedForm
from ..peers.measure import nearest_by_tree
from ..peers.mesh_metrics import Quality, quality
from ..peers.metrics import Errors, Places, errors
from ..peers.peer import Peer, Points, in_turns
from .meshers import Mesher
from .ways import BALANCED, POISSON

COUNTS = (2_000, 10_000)
LAST = COUNTS[-1]


@dataclass(frozen=True)
class Found:
    """The result of a way for a count: the number of points, their errors, points a second.

    `times` is the speed of gaussmap with density="balanced" divided by that of the way, timed in
    turns; NaN for "balanced" itself, and for all counts but the last.
    """

    points: int
    errors: Errors
    rate: float
    times: float


@dataclass(frozen=True)
class OnSurface:
    """The results on a surface: `found` by way and count, and `meshes` by mesher.

    `missing` says why a way or a mesher could not be used.
    """

    form: ClosedForm
    found: dict[tuple[Peer, int], Found] = field(default_factory=dict)
    meshes: dict[Mesher, Quality] = field(default_factory=dict)
    missing: dict[Peer | Mesher, str] = field(default_factory=dict)


def measured(
    form: ClosedForm,
    ways: Sequence[Peer],
    meshers: Sequence[Mesher],
    done: Callable[[str], object],
) -> OnSurface:
    """Judge and time all ways, and judge all meshes; `done` is called with the title of each."""
    result, places = OnSurface(form), Places.of(form)
    for way in ways:
        done(f"{form.name}: {way.title}")
        if not (missing := way.missing):
            try:
                for count in COUNTS:
                    result.found[way, count] = found(form, places, way, count)
            except NotImplementedError as error:
                missing = str(error)
        if missing:
            result.missing[way] = missing
    for mesher in meshers:
        done(f"{form.name}: mesh, {mesher.title}")
        if missing := mesher.missing:
            result.missing[mesher] = missing
        else:
            result.meshes[mesher] = quality(form, places, mesher.mesh(form, LAST))
    return result


def found(form: ClosedForm, places: Places, way: Peer, count: int) -> Found:
    """Judge a way, and time it at the last count."""
    clouds: list[Points] = []
    work = way.prepare(form, count)

    def kept() -> Points:
        clouds.append(work())
        return clouds[-1]

    timed = count == LAST and way is not BALANCED
    others = {"balanced": BALANCED.prepare(form, count)} if timed else {}
    rounds = way.rounds if way in POISSON or count == LAST else 1
    turns = in_turns(kept, others, rounds)
    judged = clouds if way in POISSON else clouds[:1]
    every = [astuple(errors(form, places, *cloud, nearest_by_tree)) for cloud in judged]
    middle = Errors(*(median(x) for x in zip(*every, strict=True)))
    times = turns.times["balanced"] * count / turns.points if timed else math.nan
    return Found(turns.points, middle, turns.points / turns.seconds, times)
