"""Samples at prescribed normals, before the gaps between them are filled."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bins import NormalBins
from ..choice import NORMALS_PER_SAMPLE
from ..developable import curved_solid_angle
from ..fields import ARRAY_NAMES
from ..inside import count_of, samples_inside
from ..lattice import Lattice
from ..report import sampling_report
from ..samples import Samples
from ..search import fill, find
from ..spline import Spline

__all__ = ["SamplesAtNormals", "no_samples", "sample_at_lattice", "sample_at_normals"]

# A lattice that gives too many samples is replaced by one with this part of the normals that would
# give as many as allowed.
FEWER = 0.98


@dataclass(frozen=True, eq=False)
class SamplesAtNormals:
    """The samples at normals (S, 3), of which there are `density` per steradian."""

    normals: NDArray[np.float64]
    density: float
    samples: Samples | None

    @property
    def samples_per_steradian(self) -> float:
        """Samples per steradian of the Gaussian image; those of the normals if it is empty."""
        if self.samples is None or self.samples.spline is None:
            return self.density
        image = curved_solid_angle(self.samples.spline, self.density)
        return len(self.samples) / image if len(self.samples) and image > 0.0 else self.density


def no_samples() -> SamplesAtNormals:
    """Return the samples at no normals."""
    return SamplesAtNormals(np.empty((0, 3)), 0.0, None)


def sample_at_normals(
    spline: Spline,
    normals: NDArray[np.float64],
    threads: int | None,
    progress: bool,
    density: float | None = None,
) -> SamplesAtNormals:
    """Return the samples at normals, by default normals of the whole sphere."""
    density = len(normals) / (4 * math.pi) if density is None else density
    bins = NormalBins(normals, threads)
    hits = find(spline, bins, threads, progress)
    arrays = fill(spline, bins, hits, threads, ARRAY_NAMES)
    arrays = samples_inside(spline, arrays, ARRAY_NAMES)
    count = count_of(arrays)
    report = sampling_report(spline, len(normals), count, density, hits.developable)
    return SamplesAtNormals(bins.normals, density, Samples(**arrays, report=report, spline=spline))


def sample_at_lattice(
    spline: Spline, density: float, threads: int | None, progress: bool, most: int | None = None
) -> SamplesAtNormals:
    """Return the samples at a lattice with a density of normals per steradian.

    If there are more than `most` samples, a coarser lattice is searched, and so on. If less than
    half a sample is expected, there is none.
    """
    lattice = Lattice.around(spline)
    image = curved_solid_angle(spline, density)
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(round(density * image), 1000))
    density = min(density, densest)
    while round(density * image) > 0:
        normals = lattice.normals(density, threads=threads)
        found = sample_at_normals(spline, normals, threads, progress, density)
        count = 0 if found.samples is None else len(found.samples)
        if most is None or count <= most:
            return found
        density *= FEWER * most / count
    return no_samples()
