"""The normals to search for: given normals, or a lattice that yields a number of samples."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.limits import MOST
from ...runtime.onto_surface.on_spline import OnPatches
from ...runtime.samples.samples import Samples
from ...runtime.search.search import Hits, find
from .fibonacci_lattice import Lattice

# The relative accuracy of the number of samples, and the largest number of attempts.
NEAR_ENOUGH = 0.01
ATTEMPTS = 20
# Attempts before IN_PROPORTION scale the density by the ratio of the requested to the found number.
# Later ones vary the density up and down in relative steps of DITHER: with few samples, several
# appear or vanish together.
IN_PROPORTION, DITHER = 6, 0.008
# The largest number of lattice normals per requested sample, for at least 1,000 requested samples:
# few normals of a lattice around a thin Gaussian image lie in it.
NORMALS_PER_SAMPLE = 100
# If points of the spline cannot be moved to the surface, the number of points to be found on the
# spline is corrected this many times.
CORRECTIONS = 3
# For larger counts, the density is extrapolated from this count.
PILOT = 1_000_000


@dataclass(frozen=True, eq=False)
class Chosen:
    """The normals to search for: an array, or a lattice with `density` normals per steradian.

    If the spline has been searched, `found` holds the normals and the hits, pairs of a normal and a
    patch that has it.
    """

    source: NDArray[np.float64] | Lattice
    density: float
    found: tuple[NDArray[np.float64], Hits] | None = None

    def __len__(self) -> int:
        """Return the number of normals."""
        if isinstance(self.source, Lattice):
            return self.source.size(self.density)
        return len(self.source)

    def part(self, first: int, last: int, threads: int | None) -> NDArray[np.float64]:
        """Return the normals with the indices [first, last)."""
        if isinstance(self.source, Lattice):
            return self.source.normals(self.density, first, last, threads)
        return self.source[first:last]

    def samples(
        self, geometry: OnPatches, fields: Sequence[str], dtype: DTypeLike, progress: bool
    ) -> tuple[Samples, NDArray[np.float64]]:
        """Return the samples at the chosen normals, and these normals.

        The search on the spline is skipped if its hits are already known.
        """
        if self.found is not None:
            normals, hits = self.found
            found = geometry.samples_at_hits(normals, hits, fields, dtype, self.density)
        else:
            normals = self.part(0, len(self), geometry.threads)
            found = geometry.samples_at(normals, fields, dtype, progress, self.density)
        # No user prescribed these normals, so that undecided ones are not reported.
        report = replace(found.report, undecided=None)
        return geometry.samples(found.arrays(), report), normals


def choose(geometry: OnPatches, count: int, progress: bool) -> Chosen:
    """Return a lattice of normals at which the surface has about `count` samples.

    For `count` > `PILOT`, the density of the lattice is extrapolated from the density for `PILOT`
    samples.
    """
    pilot = min(count, PILOT)
    chosen, hits = _adapted(geometry, pilot, progress)
    samples = _with_samples(geometry, chosen, hits)
    for _ in range(CORRECTIONS):
        if abs(samples - pilot) <= NEAR_ENOUGH * pilot or not samples:
            break
        chosen, hits = _adapted(geometry, round(hits * pilot / samples), progress)
        samples = _with_samples(geometry, chosen, hits)
    if pilot == count or not isinstance(chosen.source, Lattice):
        return chosen
    most = chosen.source.density_of(min(NORMALS_PER_SAMPLE * count, MOST))
    return Chosen(chosen.source, min(chosen.density * count / (samples or pilot), most))


def _with_samples(geometry: OnPatches, chosen: Chosen, hits: int) -> float:
    """Return an estimate of the number of samples at the chosen normals."""
    assert chosen.found is not None
    return hits * geometry.share_at(*chosen.found)


def _adapted(geometry: OnPatches, count: int, progress: bool) -> tuple[Chosen, int]:
    """Return a lattice with a density for about `count` hits (see `Chosen`), and their number."""
    spline, threads = geometry.spline, geometry.threads
    lattice = Lattice.around(spline, geometry.reach)
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(count, 1000))
    total = float(np.abs(geometry.measure[1]).sum())
    resolved = geometry.cell_measure.curved_solid_angle(min(count / max(total, 1e-300), densest))
    if resolved == 0.0:
        lattice, density = Lattice.everywhere(), count / (4 * math.pi)
    else:
        density = count / resolved
    best: Chosen | None = None
    samples = 0
    for attempt in range(1, ATTEMPTS + 1):
        density = min(density, densest)
        normals = lattice.normals(density, threads=threads)
        hits = find(spline, normals, threads, progress)
        number = geometry.number_inside(normals, hits)
        if best is None or abs(number - count) < abs(samples - count):
            best, samples = Chosen(lattice, density, (normals, hits)), number
        if abs(number - count) <= NEAR_ENOUGH * count or resolved == 0.0:
            break
        if attempt < IN_PROPORTION or number == 0:
            density *= count / number if number else 2.0
        else:
            step = attempt - IN_PROPORTION + 1
            density = count / resolved * (1.0 + (-1) ** step * (step // 2) * DITHER)
    assert best is not None
    return best, samples
