"""What normals give, before the rest is covered."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bins import NormalBins
from ..choice import NORMALS_PER_SAMPLE
from ..fields import ARRAY_NAMES
from ..lattice import Lattice
from ..report import sampling_report
from ..samples import Samples
from ..search import fill, find
from ..spline import Spline
from ..visibility import visible_solid_angle

__all__ = ["Answers", "answers_of", "answers_of_lattice", "no_answers"]

# Where a lattice gives too many samples, so much fewer are asked for than would be enough.
FEWER = 0.98


@dataclass(frozen=True, eq=False)
class Answers:
    """Samples that have one of some normals (S, 3), of which there are `density` per steradian."""

    normals: NDArray[np.float64]
    density: float
    samples: Samples | None

    @property
    def density_met(self) -> float:
        """How many of the normals there are per steradian of the Gaussian image."""
        if self.samples is None or self.samples.spline is None:
            return self.density
        seen = visible_solid_angle(self.samples.spline, self.density)
        return len(self.samples) / seen if len(self.samples) and seen > 0.0 else self.density


def no_answers() -> Answers:
    """Return what no normals give."""
    return Answers(np.empty((0, 3)), 0.0, None)


def answers_of(
    spline: Spline,
    normals: NDArray[np.float64],
    threads: int | None,
    progress: bool,
    density: float | None = None,
) -> Answers:
    """Return what normals give; without their density, they are those of the whole sphere."""
    density = len(normals) / (4 * math.pi) if density is None else density
    bins = NormalBins(normals, threads)
    hits = find(spline, bins, threads, progress)
    report = sampling_report(spline, len(normals), len(hits), density, hits.developable)
    arrays = fill(spline, bins, hits, threads, ARRAY_NAMES)
    return Answers(bins.normals, density, Samples(**arrays, report=report, spline=spline))


def answers_of_lattice(
    spline: Spline, density: float, threads: int | None, progress: bool, most: int | None = None
) -> Answers:
    """Return what a lattice of so many normals per steradian gives, if the surface shows any.

    If that is more than `most` samples, a lattice of fewer normals is searched, and so on.
    """
    lattice = Lattice.around(spline)
    seen = visible_solid_angle(spline, density)
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(round(density * seen), 1000))
    density = min(density, densest)
    while round(density * seen) > 0:
        normals = lattice.normals(density, threads=threads)
        answers = answers_of(spline, normals, threads, progress, density)
        came = 0 if answers.samples is None else len(answers.samples)
        if most is None or came <= most:
            return answers
        density *= FEWER * most / came
    return no_answers()
