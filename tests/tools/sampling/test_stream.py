"""Streams: what `sample` returns, in chunks, in bounded memory, whatever ends them."""

import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.sampling import stream

from ...refusals import refused
from ...shapes import BROKEN, same

TORUS = gm.fit(gm.surfaces.torus(), (12, 8))


def torus_part(u0, u1, v0, v1):
    """Return a part of a torus, which has open borders."""
    torus = gm.surfaces.torus()
    return gm.Surface.from_callable(torus.evaluate, ((u0, u1), (v0, v1)), name="part")


# The borders of this part lie in planes of symmetry, as many vertices of the icosahedron do.
QUARTER = gm.fit(torus_part(0.0, np.pi, -np.pi / 2, np.pi / 2), (12, 8))


# --- the same samples in the same order -----------------------------------------------------------


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("fields", [("points",), ("normal_index",), ("uv", "patch_index")])
def test_fields_and_types(fields, dtype):
    options = {"normals": gm.icosphere(5), "fields": fields, "dtype": dtype}
    for threads in (1, 2):
        chunks = gm.sample_stream(TORUS, chunk=37, threads=threads, **options)
        same(gm.Samples.concatenate(chunks), gm.sample(TORUS, **options))


def test_one_patch_with_more_samples_than_a_chunk():
    spline = gm.fit(gm.surfaces.torus(), (3, 3))
    whole = gm.sample(spline, normals=gm.fibonacci(500))
    assert np.bincount(whole.arrays()["patch_index"]).max() > 3 * 5
    chunks = list(gm.sample_stream(spline, normals=gm.fibonacci(500), chunk=5))
    assert max(map(len, chunks)) == 5
    same(gm.Samples.concatenate(chunks), whole)


def test_the_proof_of_a_block_is_counted_once(monkeypatch):
    normals = np.concatenate([gm.fibonacci(100), [[0.0, 0.0, 1.0]]])
    # The piece of the circle is too short to be found.
    part = gm.surfaces.torus().trimmed(within=lambda u, v: (v < 1.0) | (abs(u - 0.01) < 1e-3))
    whole = gm.sample(part, normals=normals)
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", 40)
    reports = [x.report for x in gm.sample_stream(part, normals=normals, chunk=4)]
    assert len(reports) > 10
    assert sum(x.proved or 0 for x in reports) == whole.report.proved == 100
    undecided = [x for report in reports for x in report.undecided or ()]
    assert [x.normal for x in undecided] == [100]


@pytest.mark.parametrize("size", [10, 64, 333])
@pytest.mark.parametrize("asked", [{"normals": gm.icosphere(6)}, {"count": 700}])
def test_blocks_of_normals(size, asked, monkeypatch):
    """The same samples in the same order."""
    whole = gm.sample(TORUS, density="gauss", **asked)
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", size)
    chunks = list(gm.sample_stream(TORUS, chunk=50, **asked))
    assert max(map(len, chunks)) <= 50
    joined = gm.Samples.concatenate(chunks)
    same(joined, whole)
    assert joined.report.normals == whole.report.normals


def test_normals_may_be_changed_before_the_last_chunk(monkeypatch):
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", 40)
    normals = gm.fibonacci(200)
    whole = gm.Samples.concatenate(gm.sample_stream(TORUS, normals=normals, chunk=20))
    chunks = gm.sample_stream(TORUS, normals=normals, chunk=20)
    first = next(chunks)
    normals[:] = [0.0, 0.0, 1.0]
    same(gm.Samples.concatenate([first, *chunks]), whole)


# --- what there is to say -------------------------------------------------------------------------


def test_no_samples_are_one_empty_chunk():
    empty = gm.sample_stream(gm.surfaces.plane(), normals=[[0, 1, 0]], cells=(8, 8), fields=("uv",))
    with pytest.warns(gm.GaussmapWarning, match="flat or developable") as caught:
        chunks = [*empty]
    assert [len(x) for x in chunks] == [0]
    assert chunks[0].uv.shape == (0, 2)
    assert len(caught) == 1
    assert caught[0].filename == __file__


def test_no_samples_of_several_blocks(monkeypatch):
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", 1)
    with pytest.warns(gm.GaussmapWarning, match="none of the normals lies in its Gaussian image"):
        chunks = list(gm.sample_stream(QUARTER, normals=[[-1, -1, 0]] * 3))
    assert [len(x) for x in chunks] == [0]
    # nothing in the first and in the last block
    normals = [[-1, -1, 0], [1, 2, 3], [-1, -1, 0]]
    assert [len(x) for x in gm.sample_stream(QUARTER, normals=normals)] == [1]


def test_reports_count_their_chunk():
    chunks = list(gm.sample_stream(TORUS, normals=gm.icosphere(4), chunk=50))
    for chunk in chunks:
        assert chunk.report.samples == len(chunk)
        assert chunk.report.developable_patches is None
        assert (chunk.report.normals, chunk.report.patches) == (162, TORUS.patches)
    used = len(set(chunks[0].normal_index.tolist()))
    assert f"50 samples at {used} of 162 prescribed normals" in chunks[0].summary()


@pytest.mark.parametrize(
    "asked",
    [{}, {"count": 5, "normals": [[0, 0, 1]]}, {"count": 0}, {"normals": [[0, 0, 0]]},
     *({"count": 5, "chunk": x} for x in (0, 2.5, "many")),
     {"count": 5, "threads": 0}, {"count": 5, "cells": (4, 4)}],
)  # fmt: skip
def test_errors_come_at_once(asked):
    refused("", gm.sample_stream, TORUS, **asked)
    refused("", gm.sample_stream, BROKEN, 5, error=gm.errors.SurfaceError)


# --- at once --------------------------------------------------------------------------------------


def test_streams_in_several_python_threads():
    whole = gm.sample(TORUS, normals=gm.icosphere(8))
    narrow = gm.sample(TORUS, normals=gm.icosphere(8), fields=("points",), dtype=np.float32)
    start = threading.Barrier(6, timeout=30)

    def work(k):
        options = {"fields": ("points",), "dtype": np.float32} if k % 2 else {}
        options |= {"chunk": 100 + k, "threads": 1 + k % 3}
        start.wait()
        return gm.Samples.concatenate(gm.sample_stream(TORUS, normals=gm.icosphere(8), **options))

    with ThreadPoolExecutor(6) as pool:
        for k, samples in enumerate(pool.map(work, range(6))):
            same(samples, narrow if k % 2 else whole)


def test_streams_may_be_interleaved():
    first = gm.sample_stream(TORUS, normals=gm.icosphere(6), chunk=20)
    second = gm.sample_stream(QUARTER, normals=gm.icosphere(6), chunk=7)
    parts = [one for one, _ in zip(first, second, strict=False)]
    assert len(parts) > 3
    same(
        gm.Samples.concatenate(parts), gm.sample(TORUS, normals=gm.icosphere(6))[: 20 * len(parts)]
    )


# --- memory ---------------------------------------------------------------------------------------

REDUCE = """
import resource
import gaussmap as gm

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

for _ in gm.sample_stream(gm.surfaces.torus(), count=1000):
    pass
before = peak()
came = sum(len(x) for x in gm.sample_stream(gm.surfaces.torus(), count=20_000_000, chunk=100_000))
print(came, peak() - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the peak is in other units")
@pytest.mark.slow
def test_memory_is_bounded():
    """The samples would take 2.1 GB, and 240 MB of normals more; neither is ever there."""
    done = subprocess.run(
        [sys.executable, "-c", REDUCE], capture_output=True, text=True, check=True
    )
    came, grown = map(int, done.stdout.split())
    assert abs(came - 20_000_000) <= 1_000_000
    # A block of 2²⁰ normals, sorted: 24 + 24 + 8 + 4 bytes each, and bins; what two sheets of it
    # have: 24 bytes a sample, twice while ranges are joined. A chunk: 104 bytes a sample, twice.
    assert grown < 2**20 * (64 + 2 * 2 * 24) + 100_000 * 2 * 104 + 200e6
