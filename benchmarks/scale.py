"""Growth of the time of gm.sample with the number of samples, and with that of patches.

The surface is the torus, and the normals are a Fibonacci lattice. Numbers of samples or patches
above `largest` are left out. More than STREAMED samples come in chunks from gm.sample_stream, and
are only counted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import gaussmap as gm
import numpy as np

SIZES = tuple(10**k for k in range(3, 9))
STREAMED = 10**7
LAST = 3  # the number of the largest sizes for the second slope
FIXED_CELLS = 64
FIXED_NORMALS = 500
TORUS = gm.surfaces.torus()


@dataclass(frozen=True)
class Series:
    """Times for growing sizes: a row is (patches, samples, seconds)."""

    title: str
    rows: Sequence[tuple[int, int, float]]

    def slope(self, last: int = 0) -> float:
        """Return the slope of log(time) against log(patches + samples), over the `last` sizes."""
        return slope([(patches + samples, t) for patches, samples, t in self.rows[-last:]])


def slope(pairs: Sequence[tuple[float, float]]) -> float:
    """Return the slope of log(y) against log(x) by least squares; ValueError for a single x."""
    if len({x for x, _ in pairs}) < 2:
        raise ValueError("a slope needs two sizes")
    x, y = np.log(np.array(pairs, dtype=float)).T
    return float(np.polyfit(x, y, 1)[0])


def measure(largest: int) -> list[Series]:
    """Measure both series up to a size of `largest`."""
    return [by_samples(largest), by_patches(largest)]


def by_samples(largest: int) -> Series:
    """Time growing numbers of normals for a spline of 64 × 64 cells."""
    spline = gm.fit(TORUS, (FIXED_CELLS, FIXED_CELLS))
    rows = []
    for size in (x for x in SIZES if x <= largest):
        if size > STREAMED:
            taken, samples = _time(lambda size=size: _streamed(spline, size), size)
        else:
            normals = gm.fibonacci(size // 2)  # the torus has every normal twice
            taken, samples = _time(
                lambda normals=normals: len(gm.sample(spline, normals=normals)), size
            )
        rows.append((spline.patches, samples, taken))
    return Series(f"samples, {spline.patches:,} patches", rows)


def by_patches(largest: int) -> Series:
    """Time finer and finer splines for the same normals; their fit is not timed."""
    normals = gm.fibonacci(FIXED_NORMALS)
    rows = []
    for size in (x for x in SIZES if x <= largest):
        cells = round(math.sqrt(size / 4))
        spline = gm.fit(TORUS, (cells, cells))
        taken, samples = _time(
            lambda spline=spline: len(gm.sample(_fresh(spline), normals=normals)), size
        )
        rows.append((spline.patches, samples, taken))
    return Series(f"patches, {len(normals):,} normals", rows)


def _fresh(spline: gm.Spline) -> gm.Spline:
    """Return the spline without cached properties."""
    return gm.Spline(spline.coefficients, spline.domain, spline.boundary, spline.name)


def _streamed(spline: gm.Spline, count: int) -> int:
    """Count the samples of a stream, without keeping them."""
    return sum(len(chunk) for chunk in gm.sample_stream(spline, count=count))


def _time(work: Callable[[], int], size: int) -> tuple[float, int]:
    """Return the median seconds of some runs, fewer for large sizes, and the number of samples."""
    samples, times = 0, []
    if size <= 10**6:
        work()
    for _ in range(7 if size <= 10**5 else 3 if size <= 10**7 else 1):
        start = perf_counter()
        samples = work()
        times.append(perf_counter() - start)
    return median(times), samples
