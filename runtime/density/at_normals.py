"""Samples at prescribed normals, before the gaps between them are filled."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..place.on_spline import OnSpline
from ..samples.fields import ARRAY_NAMES_ON_SURFACE
from ..samples.report import sampling_report
from ..samples.samples import Samples
from ..search.bins import NormalBins
from ..search.search import find
from ..spline.developable import curved_solid_angle
from .chosen_normals import NORMALS_PER_SAMPLE
from .fibonacci_lattice import Lattice

__all__ = ["SamplesAtNormals", "no_samples", "sample_at_lattice", "sample_at_normals"]

# A lattice that gives too many samples is replaced by one with this part of the normals that would
# give as many as allowed.
FEWER = 0.98


@dataclass(frozen=True, eq=False)
class SamplesAtNormals:
    """The samples at normals (S, 3), of which there are `density` per steradian."""

    geometry: OnSpline | None
    normals: NDArray[np.float64]
    density: float
    samples: Samples | None

    @property
    def samples_per_steradian(self) -> float:
        """Samples per steradian of the Gaussian image; those of the normals if it is empty."""
        if self.samples is None or self.geometry is None:
            return self.density
        image = curved_solid_angle(self.geometry, self.density)
        return len(self.samples) / image if len(self.samples) and image > 0.0 else self.density


def no_samples() -> SamplesAtNormals:
    """Return the samples at no normals."""
    return SamplesAtNormals(None, np.empty((0, 3)), 0.0, None)


def sample_at_normals(
    geometry: OnSpline,
    normals: NDArray[np.float64],
    progress: bool,
    density: float | None = None,
) -> SamplesAtNormals:
    """Return the samples at normals, by default normals of the whole sphere."""
    density = len(normals) / (4 * math.pi) if density is None else density
    bins = NormalBins(normals, geometry.threads)
    hits = find(geometry.spline, bins, geometry.threads, progress)
    found = geometry.at_hits(bins, hits, ARRAY_NAMES_ON_SURFACE, np.float64)
    report = sampling_report(geometry, len(normals), found.number, density, hits.developable)
    samples = geometry.samples(found.fields, report, found.unrefined)
    return SamplesAtNormals(geometry, bins.normals, density, samples)


def sample_at_lattice(
    geometry: OnSpline, density: float, progress: bool, most: int | None = None
) -> SamplesAtNormals:
    """Return the samples at a lattice with a density of normals per steradian.

    If there are more than `most` samples, a coarser lattice is searched, and so on. If less than
    half a sample is expected, there is none.
    """
    lattice = Lattice.around(geometry.spline)
    image = curved_solid_angle(geometry, density)
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(round(density * image), 1000))
    density = min(density, densest)
    while round(density * image) > 0:
        normals = lattice.normals(density, threads=geometry.threads)
        found = sample_at_normals(geometry, normals, progress, density)
        count = 0 if found.samples is None else len(found.samples)
        if most is None or count <= most:
            return found
        density *= FEWER * most / count
    return no_samples()
