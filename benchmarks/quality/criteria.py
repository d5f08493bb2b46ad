"""Targets for gaussmap, and whether they are met."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..peers.mesh_metrics import Quality
from ..peers.peer import Peer
from .measure import COUNTS, LAST, OnSurface
from .meshers import GMSH_MESH, THROUGH_ALIGNED, THROUGH_BALANCED, Mesher
from .ways import ALIGNED, BALANCED, GAUSS, PERFECT, POISSON

__all__ = ["CRITERIA", "Criterion", "Verdict", "verdicts", "worst"]

Value = Callable[[OnSurface, int], float | None]  # None if somebody is missing

CURVED = ("torus", "ellipsoid_patch", "boss", "boss0.3")


@dataclass(frozen=True)
class Criterion:
    """A value that is to stay below `limit` on `surfaces` (all, if none are named) at `counts`.

    With `at_least`, above it.
    """

    title: str
    value: Value
    limit: float
    surfaces: tuple[str, ...] = ()
    counts: tuple[int, ...] = COUNTS
    strict: bool = False
    at_least: bool = False

    def met(self, value: float) -> bool:
        """Whether a value is good enough."""
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
    surface: str
    count: int
    value: float | None

    @property
    def met(self) -> bool | None:
        """Whether it is met; None if that is not known."""
        return None if self.value is None else self.criterion.met(self.value)


def error(way: Peer, quantity: str) -> Value:
    """Return an error of a way."""

    def value(on: OnSurface, count: int) -> float | None:
        found = on.found.get((way, count))
        return None if found is None else getattr(found.errors, quantity)

    return value


def ratio(own: Value, other: Value) -> Value:
    """Return a value over another one."""

    def value(on: OnSurface, count: int) -> float | None:
        left, right = own(on, count), other(on, count)
        return None if left is None or right is None else left / right

    return value


def errors_over(own: Peer, other: Peer, quantity: str) -> Value:
    """Return the ratio of an error of two ways."""
    return ratio(error(own, quantity), error(other, quantity))


def over_gmsh(mesher: Mesher, quantity: Callable[[Quality], float]) -> Value:
    """Return the ratio of an error of two meshes: the given one, and that of Gmsh."""

    def value(on: OnSurface, count: int) -> float | None:
        own, other = on.meshes.get(mesher), on.meshes.get(GMSH_MESH)
        return None if own is None or other is None else quantity(own) / quantity(other)

    return value


def speed_over(other: Peer) -> Value:
    """Return the ratio of points per second, timed in turns."""

    def value(on: OnSurface, count: int) -> float | None:
        found = on.found.get((other, count))
        return None if found is None else found.times

    return value


def _aligned() -> Iterator[Criterion]:
    at_last = (LAST,)
    for surface, limit in (("torus", 2.6), ("boss", 2.0), ("ellipsoid_patch", 2.4),
                           ("boss0.3", 3.0)):  # fmt: skip
        yield Criterion("aligned, E", error(ALIGNED, "E"), limit, (surface,), at_last)
    yield Criterion("aligned, G", error(ALIGNED, "G"), 1.3, ("ellipsoid_patch",), at_last)


def _meshes() -> Iterator[Criterion]:
    quantities: tuple[tuple[str, Callable[[Quality], float]], ...] = (
        ("worst angle", lambda x: x.worst),
        ("Hausdorff distance", lambda x: x.hausdorff),
    )
    for title, quantity in quantities:
        for name, mesher, limit, surfaces in (
            ("aligned", THROUGH_ALIGNED, 0.6, CURVED),
            ("balanced", THROUGH_BALANCED, 1.05, ("wavy_graph", "monkey_saddle")),
        ):
            value = over_gmsh(mesher, quantity)
            yield Criterion(f"mesh, {name} : Gmsh, {title}", value, limit, surfaces, (LAST,))


def _criteria() -> Iterator[Criterion]:
    yield from _aligned()
    yield from _meshes()
    yield Criterion("gauss : exact, G", errors_over(GAUSS, PERFECT, "G"), 1.05)
    for peer in POISSON:
        name = peer.title.partition(",")[0]
        yield Criterion(f"balanced : {name}, E", errors_over(BALANCED, peer, "E"), 1.0)
        value = errors_over(BALANCED, peer, "G")
        yield Criterion(f"balanced : {name}, G", value, 1.0, strict=True)
        yield Criterion(
            f"balanced : {name}, speed", speed_over(peer), 20.0, counts=(LAST,), at_least=True
        )


CRITERIA = tuple(_criteria())


def verdicts(criterion: Criterion, surfaces: tuple[OnSurface, ...]) -> list[Verdict]:
    """Judge all surfaces that a criterion is for."""
    return [
        Verdict(criterion, on.form.name, count, criterion.value(on, count))
        for on in surfaces
        if not criterion.surfaces or on.form.name in criterion.surfaces
        for count in criterion.counts
    ]


def worst(found: list[Verdict]) -> Verdict | None:
    """Return the verdict that is farthest from being met; None if no value is known."""
    known = [x for x in found if x.value is not None]
    sign = -1.0 if known and known[0].criterion.at_least else 1.0
    return max(known, key=lambda x: sign * (x.value or 0.0), default=None)
