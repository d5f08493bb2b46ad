"""Which density to take for which task, and where others are better: from what was measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from gaussmap.docs.orders import listed, markdown

from ..peers.peer import Peer
from .measure import LAST, OnSurface
from .meshers import OTHER_MESHERS, OWN_MESHERS, Mesher
from .ways import BALANCED, DENSITIES, OTHERS

__all__ = ["TASKS", "Measure", "Task", "table"]

NEAR = 1.02  # the default is taken if it is as good as the best one but for this factor
FEW = 2  # surfaces that are named; more are counted

Way = Peer | Mesher


@dataclass(frozen=True)
class Measure:
    """A quantity that is to be small, and its values on a surface by way."""

    title: str
    values: Callable[[OnSurface], Mapping[Way, float]]


@dataclass(frozen=True)
class Task:
    """What samples or meshes are made for, and what counts there.

    `own` are the ways of gaussmap, of which the first is the default and `base` the one with which
    all are compared.
    """

    title: str
    measures: tuple[Measure, ...]
    own: Sequence[Way] = DENSITIES
    base: Way = BALANCED
    others: Sequence[Way] = OTHERS


def of_points(title: str, quantity: str) -> Measure:
    """Return an error of points."""

    def values(on: OnSurface) -> Mapping[Way, float]:
        return {way: getattr(x.errors, quantity) for (way, n), x in on.found.items() if n == LAST}

    return Measure(title, values)


def of_meshes(title: str, quantity: str) -> Measure:
    """Return an error of meshes."""

    def values(on: OnSurface) -> Mapping[Way, float]:
        return {mesher: getattr(x, quantity) for mesher, x in on.meshes.items()}

    return Measure(title, values)


E, MEAN = of_points("E", "E"), of_points("mean E", "mean")
G, GAP = of_points("G", "G"), of_points("gap", "gap")
MESHES = tuple(
    of_meshes(title, quantity)
    for title, quantity in (
        ("worst angle", "worst"),
        ("mean angle", "mean"),
        ("Hausdorff distance", "hausdorff"),
    )
)
NORMAL_MESHERS = OWN_MESHERS[1:]  # those that prefer normals
TASKS = (
    Task("registration", (of_points("plane", "plane"),)),
    Task("meshing", MESHES, NORMAL_MESHERS, NORMAL_MESHERS[0], OTHER_MESHERS),
    Task("inspection", (GAP, G)),
    Task("look-up, learning", (MEAN, GAP)),
    Task("no normal may be far off", (E,)),
)


def compared(measure: Measure, task: Task, way: Way, surfaces: Sequence[OnSurface]) -> float:
    """Return the geometric mean over the surfaces of a value relative to that of `task.base`."""
    every = [measure.values(on) for on in surfaces]
    logs = [math.log(values[way] / values[task.base]) for values in every]
    return math.exp(math.fsum(logs) / len(logs))


def taken(task: Task, surfaces: Sequence[OnSurface]) -> Way:
    """Return the best way over all that counts; the default where it is about as good."""
    total = {
        way: math.prod(compared(x, task, way, surfaces) for x in task.measures)
        ** (1.0 / len(task.measures))
        for way in task.own
    }
    default, best = task.own[0], min(total, key=total.__getitem__)
    return default if total[default] <= NEAR * total[best] else best


def better(measure: Measure, task: Task, way: Way, surfaces: Sequence[OnSurface]) -> Iterator[str]:
    """Yield who is better than `way`, on which surfaces, and the best ratio."""
    for other in task.others:
        ratios = {}
        for on in surfaces:
            values = measure.values(on)
            if other in values and values[other] < values[way]:
                ratios[on.form.name] = values[other] / values[way]
        if ratios:
            where = listed(ratios) if len(ratios) <= FEW else f"{len(ratios)} surfaces"
            yield f"{short(other)}: {where} ({min(ratios.values()):.2f})"


def short(way: Way) -> str:
    """Return the title of a way without its setting."""
    title = way.title.replace(", prefer", "|")
    for setting in (", curvature", ", angular"):
        title = title.replace(setting, "|")
    return title.partition("|")[0]


def table(surfaces: Sequence[OnSurface]) -> str:
    """Return the table of all tasks."""
    names = [way.title for way in DENSITIES]
    header = ["task", "take", "what counts", *(x.strip("*") for x in names)]
    rows = []
    for task in TASKS:
        best = taken(task, surfaces)
        for k, measure in enumerate(task.measures):
            cells = {
                short(way): f"{compared(measure, task, way, surfaces):.2f}" for way in task.own
            }
            first = [task.title, short(best)] if k == 0 else ["", ""]
            others = "; ".join(better(measure, task, best, surfaces)) or "nowhere"
            rows.append([*first, measure.title, *(cells.get(x, "–") for x in names), others])
    return markdown([*header, "where others are better"], rows)
