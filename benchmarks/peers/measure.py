"""Timing every peer and gaussmap in turns on one surface, and judging their points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from statistics import median

import gaussmap as gm
from gaussmap.tools.density.request import checked_request
from gaussmap.tools.sampling.sample import sample_and_normals

from .catalogue import MILLION
from .forms import Array, ClosedForm
from .metrics import Places, both, nearest_by_tree
from .peer import Peer, in_turns, timed
from .splines import surface_of_net

JUDGED = 10_000
OWN_ROUNDS = 7


@dataclass(frozen=True)
class Measured:
    """The results of a peer on a surface; all numbers are 0 if `missing` says why it is not used.

    `preparation` is in seconds, `rate` in points a second. `times_same` and `times_million` are the
    rate of gaussmap divided by that of the peer, for the same count and for 10⁶ points. `errors`
    are E and G of about JUDGED points, see `metrics.Errors`.
    """

    peer: Peer
    missing: str = ""
    points: int = 0
    preparation: float = 0.0
    rate: float = 0.0
    times_same: float = 0.0
    times_million: float = 0.0
    errors: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Own:
    """The speed of a call of gaussmap: `rate`, in points a second."""

    call: str
    points: int
    rate: float


@cache
def surface(form: ClosedForm, on_net: bool) -> gm.Surface:
    """Return the surface for gaussmap, by its formulas or as the B-spline."""
    return surface_of_net(form) if on_net else form.surface


@cache
def normals_for(form: ClosedForm, count: int) -> Array:
    """Return normals that give about `count` samples: those that gaussmap itself chooses."""
    request = checked_request(None, count, None, None, "gauss", None)
    return sample_and_normals(form.surface, request, cells=None, threads=None, progress=False)[1]


def sampling(form: ClosedForm, on_net: bool, count: int) -> Callable[[], gm.Samples]:
    """Return the sampling of about `count` points from the surface itself, the fit included."""
    source, normals = surface(form, on_net), normals_for(form, count)
    return lambda: gm.sample(source, normals=normals)


def measure(form: ClosedForm, places: Places, peer: Peer) -> Measured:
    """Time a peer in turns with gaussmap, and judge its points."""
    if missing := peer.missing:
        return Measured(peer, missing)
    judged = peer.prepare(form, JUDGED)()
    preparation, work = timed(lambda: peer.prepare(form, peer.count))
    same, million = (sampling(form, peer.on_net, x) for x in (peer.count, MILLION))
    turns = in_turns(work, {"same": same, "million": million}, peer.rounds)
    return Measured(
        peer,
        points=turns.points,
        preparation=preparation,
        rate=turns.points / turns.seconds,
        times_same=turns.times["same"] * peer.count / turns.points,
        times_million=turns.times["million"] * MILLION / turns.points,
        errors=both(form, places, *judged, nearest_by_tree),
    )


def measure_own(form: ClosedForm) -> list[Own]:
    """Time calls of gaussmap; each runs once, untimed, before it is timed."""
    source, spline, normals = form.surface, gm.fit(form.surface), normals_for(form, MILLION)
    calls: list[tuple[str, Callable[[], gm.Samples]]] = [
        ("gm.sample(surface, normals=normals)", sampling(form, False, 100_000)),
        ("gm.sample(surface, normals=normals)", sampling(form, False, MILLION)),
        (
            'gm.sample(surface, count=…, density="gauss")',
            lambda: gm.sample(source, count=MILLION, density="gauss"),
        ),
        ("gm.sample(spline, normals=normals)", lambda: gm.sample(spline, normals=normals)),
    ]
    rows = []
    for call, work in calls:
        points = len(work())
        rows.append(Own(call, points, points / median(timed(work)[0] for _ in range(OWN_ROUNDS))))
    return rows


def judge_own(form: ClosedForm, places: Places) -> tuple[float, float]:
    """Return E and G of about JUDGED samples of gaussmap."""
    samples = gm.sample(form.surface, count=JUDGED, density="gauss")
    return both(form, places, samples.points, samples.normals, nearest_by_tree)
