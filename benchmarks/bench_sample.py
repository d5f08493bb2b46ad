"""Sampling, compared with the time of writing the same arrays.

The writing limit is a compiled loop on the same number of threads that stores constants into arrays
of the same shapes. `of_writing_limit` is relative to a loop that stores into memory it holds, which
no sampler that returns new arrays can reach, because the system has to give it new memory.
`of_new_array_limit` is relative to the same loop on new arrays.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.writing import Writers, new_arrays
from gaussmap.runtime.search.hits import fill
from gaussmap.runtime.search.search import find

TORUS = gm.surfaces.torus()


@pytest.fixture(scope="module")
def limits():
    """Make the writing limits for a number of samples."""
    with Writers() as write:

        def make(count):
            held = new_arrays(count)
            return {
                "writing_limit": lambda: write(held),
                "new_array_limit": lambda: write(new_arrays(count)),
            }

        yield make


@dataclass(frozen=True)
class Case:
    """Normals, a spline of the torus, and the number of rounds."""

    normals: np.ndarray
    spline: gm.Spline
    rounds: int

    @property
    def hits(self):
        return find(self.spline, self.normals)


# The torus has every normal twice: 4 n² patches share 2 S samples.
CASES = {
    "icosphere-100k-781-a-patch": (lambda: gm.icosphere(100), 8, 9),
    "icosphere-100k-5-a-patch": (lambda: gm.icosphere(100), 100, 9),
    "fibonacci-100k-781-a-patch": (lambda: gm.fibonacci(100_000), 8, 15),
    "fibonacci-100k-5-a-patch": (lambda: gm.fibonacci(100_000), 100, 15),
    "fibonacci-1M-556-a-patch": (lambda: gm.fibonacci(1_000_000), 30, 5),
    "fibonacci-1M-5-a-patch": (lambda: gm.fibonacci(1_000_000), 320, 5),
}


@pytest.fixture(scope="module", params=CASES.values(), ids=list(CASES))
def case(request):
    normals, cells, rounds = request.param
    return Case(normals(), gm.fit(TORUS, (cells, cells)), rounds)


@pytest.fixture(scope="module")
def hits(case):
    return case.hits


@pytest.fixture
def against_limit(compare, limits, case, hits):
    """Compare with the limits of writing the same number of samples."""
    return partial(
        compare,
        limits=limits(len(hits)),
        units={"samples": len(hits)},
        rounds=case.rounds,
        samples_per_patch=len(hits) / case.spline.patches,
        exact_decisions=len(hits.exact),
    )


def test_sample(against_limit, case):
    """All of gm.sample for a spline without cached properties."""
    against_limit(lambda: gm.sample(replace(case.spline), normals=case.normals))


def test_find(against_limit, case):
    against_limit(lambda: find(case.spline, case.normals))


def test_fill(against_limit, case, hits):
    against_limit(lambda: fill(case.spline, case.normals, hits))
