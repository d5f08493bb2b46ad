"""Which normals are searched: those that are given, or as many as bring a number of samples."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bins import NormalBins
from .developable import curved_solid_angle
from .lattice import Lattice
from .limits import MOST
from .search import Hits, find
from .spline import Spline

__all__ = ["Chosen", "choose"]

# The accuracy to which `count` is met by changing the number of normals, and the most attempts.
NEAR_ENOUGH = 0.01
TRIES = 20
# The first attempts change the density in proportion, the others by this factor up and down: if
# there are few samples, several appear or vanish at once.
IN_PROPORTION, DITHER = 6, 0.008
# At most this many normals for each requested sample (a thin Gaussian image has few of them).
NORMALS_PER_SAMPLE = 100
# For a larger count, the density is extrapolated from this one.
PILOT = 1_000_000


@dataclass(frozen=True, eq=False)
class Chosen:
    """The normals to search for, `density` of them per steradian: an array, or those of a lattice.

    If they have been searched already, `found` is the result.
    """

    source: NDArray[np.float64] | Lattice
    density: float
    found: tuple[NormalBins, Hits] | None = None

    def __len__(self) -> int:
        """Return how many normals there are."""
        if isinstance(self.source, Lattice):
            return self.source.size(self.density)
        return len(self.source)

    def part(self, first: int, last: int, threads: int | None) -> NDArray[np.float64]:
        """Return the normals first, …, last − 1."""
        if isinstance(self.source, Lattice):
            return self.source.normals(self.density, first, last, threads)
        return self.source[first:last]


def choose(
    spline: Spline, asked: NDArray[np.float64] | int, threads: int | None, progress: bool
) -> Chosen:
    """Return the prescribed normals `asked`, or normals with about `asked` samples.

    For more samples than `PILOT`, the number of normals is extrapolated from that.
    """
    if not isinstance(asked, int):
        return Chosen(asked, len(asked) / (4 * math.pi))
    pilot = min(asked, PILOT)
    chosen, came = _tried(spline, pilot, threads, progress)
    if pilot == asked or not isinstance(chosen.source, Lattice):
        return chosen
    most = chosen.source.density_of(min(NORMALS_PER_SAMPLE * asked, MOST))
    return Chosen(chosen.source, min(chosen.density * asked / (came or pilot), most))


def _tried(spline: Spline, count: int, threads: int | None, progress: bool) -> tuple[Chosen, int]:
    """Change the density of a lattice until about `count` samples come; return how many came."""
    lattice = Lattice.around(spline)
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(count, 1000))
    everything = float(np.abs(spline.measure[1]).sum())
    resolved = curved_solid_angle(spline, min(count / max(everything, 1e-300), densest))
    if resolved == 0.0:
        lattice, density = Lattice.everywhere(), count / (4 * math.pi)
    else:
        density = count / resolved
    best: Chosen | None = None
    came = 0
    for tried in range(1, TRIES + 1):
        density = min(density, densest)
        bins = NormalBins(lattice.normals(density, threads=threads), threads)
        hits = find(spline, bins, threads, progress)
        if best is None or abs(len(hits) - count) < abs(came - count):
            best, came = Chosen(lattice, density, (bins, hits)), len(hits)
        if abs(len(hits) - count) <= NEAR_ENOUGH * count or resolved == 0.0:
            break
        if tried < IN_PROPORTION or len(hits) == 0:
            density *= count / len(hits) if len(hits) else 2.0
        else:
            step = tried - IN_PROPORTION + 1
            density = count / resolved * (1.0 + (-1) ** step * (step // 2) * DITHER)
    assert best is not None
    return best, came
