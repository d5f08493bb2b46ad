"""Whole calls as users make them: with reused memory, streams, densities, threads, and meshes.

Limits are those of `bench_sample`. The baseline of a stream and of a mesh is `gm.sample`, that of
several threads is one thread, and that of a density is the same number of samples at normals alone.
"""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.writing import Writers, new_arrays
from gaussmap.runtime.search.hits import fill
from gaussmap.runtime.search.search import find
from matplotlib.cbook import get_sample_data

TORUS = gm.surfaces.torus()
THREADS = 2


def terrain() -> gm.Spline:
    """Return real terrain with 200 × 200 cells."""
    file = get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)
    with np.load(str(file)) as data:
        heights = np.asarray(data["elevation"], dtype=np.float64)[:200, :200]
    y, x = np.indices(heights.shape)
    return gm.fit(gm.Surface.from_grid(np.stack([74.5 * x, -92.5 * y, heights], axis=-1)))


# Normals, a spline, and the number of rounds.
WHOLE = {
    "fibonacci-1M-64x64": (lambda: gm.fibonacci(1_000_000), lambda: gm.fit(TORUS, (64, 64)), 5),
    "icosphere-100-64x64": (lambda: gm.icosphere(100), lambda: gm.fit(TORUS, (64, 64)), 9),
    "icosphere-100-256x256": (lambda: gm.icosphere(100), lambda: gm.fit(TORUS, (256, 256)), 5),
    "icosphere-100-terrain": (lambda: gm.icosphere(100), terrain, 5),
}
DENSITIES = {
    "balanced-10k": {"count": 10_000},
    "aligned-10k": {"count": 10_000, "density": "aligned"},
    "balanced-100k": {"count": 100_000},
    "aligned-100k": {"count": 100_000, "density": "aligned"},
    "angle-2-degrees": {"angle": 2.0},
}


@pytest.fixture(scope="module", params=WHOLE.values(), ids=list(WHOLE))
def whole(request):
    normals, spline, rounds = request.param
    return normals(), spline(), rounds


def test_whole_call(compare, whole):
    normals, spline, rounds = whole
    count = len(gm.sample(spline, normals=normals))
    with Writers() as write:
        compare(
            lambda: gm.sample(spline, normals=normals),
            limits={"new_array_limit": lambda: write(new_arrays(count))},
            units={"samples": count},
            rounds=rounds,
        )


def test_whole_call_with_out(compare, whole):
    normals, spline, rounds = whole
    held = gm.sample(spline, normals=normals)
    arrays, known = new_arrays(len(held)), gm.GaussMap(spline)
    with Writers() as write:
        compare(
            lambda: known.points(normals, out=held),
            limits={"writing_limit": lambda: write(arrays)},
            units={"samples": len(held)},
            rounds=rounds,
        )


def test_stream(compare):
    spline, number = gm.fit(TORUS, (64, 64)), 4_000_000
    compare(
        lambda: sum(map(len, gm.sample_stream(spline, number))),
        baselines={"sample": lambda: len(gm.sample(spline, number, density="gauss"))},
        units={"samples": number},
        rounds=3,
    )


@pytest.mark.parametrize("step", ["find", "fill"])
@pytest.mark.parametrize("cells", [8, 64, 256])
def test_threads(compare, step, cells):
    """Kernels in two threads; the baseline is one thread."""
    spline, normals = gm.fit(TORUS, (cells, cells)), gm.icosphere(200)
    hits = find(spline, normals)

    def run(threads: int) -> None:
        if step == "find":
            find(spline, normals, threads)
        else:
            fill(spline, normals, hits, threads)

    compare(
        lambda: run(THREADS),
        baselines={"one_thread": lambda: run(1)},
        units={"samples": len(hits)},
        rounds=9,
    )


@pytest.mark.parametrize("arguments", DENSITIES.values(), ids=list(DENSITIES))
def test_density(compare, arguments):
    count = len(gm.sample(TORUS, **arguments))
    compare(
        lambda: gm.sample(TORUS, **arguments),
        baselines={"gauss": lambda: gm.sample(TORUS, count, density="gauss")},
        units={"samples": count},
        rounds=3,
    )


@pytest.mark.parametrize("density", ["balanced", "aligned"])
def test_mesh(compare, density):
    samples = gm.sample(TORUS, 20_000, density=density)
    compare(
        samples.mesh,
        baselines={"sample": lambda: gm.sample(TORUS, 20_000, density=density)},
        units={"samples": len(samples)},
        rounds=3,
    )
