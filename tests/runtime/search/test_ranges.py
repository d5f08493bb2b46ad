"""Ranges of normals, on several threads, whole or in chunks: they do not show in the samples."""

import gc
import threading
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search import exact, search
from gaussmap.runtime.search import hits as fill

from ...shapes import same, same_chunks

# The vertices of the icosphere lie in planes of symmetry: some samples are decided exactly.
SPLINE, NORMALS = gm.fit(gm.surfaces.torus(), (12, 8)), gm.icosphere(6)


# --- what is stored -------------------------------------------------------------------------------


def test_proved_samples_are_in_the_order_of_normals_and_of_u_and_v():
    samples = gm.sample("torus", normals=NORMALS)
    keys = np.column_stack([samples.normal_index, samples.uv]).tolist()
    assert keys == sorted(keys)


def test_samples_of_one_patch_and_of_the_next_have_their_normals():
    """Samples of hundreds of patches are filled at a time, and there is a rest."""
    spline, normals = gm.fit("torus", (4, 3)), gm.fibonacci(4000)
    samples = gm.sample(spline, normals=normals)
    assert np.bincount(samples.arrays()["patch_index"]).max() > 200
    np.testing.assert_array_equal(samples.normals, normals[samples.normal_index])
    u, v = samples.uv.T
    np.testing.assert_allclose(spline.evaluate(u, v), samples.points, rtol=0, atol=1e-12)
    np.testing.assert_allclose(spline.normals(u, v), samples.normals, rtol=0, atol=1e-6)


@pytest.mark.parametrize("apart", [1e-12, 0.1])
def test_one_point_of_the_border_is_one_sample(apart, monkeypatch):
    """Points of the border are found from both sides up to rounding, and no others are near."""
    helicoid, normals = gm.fit(gm.surfaces.helicoid(), (16, 16)), gm.icosphere(12)
    usual = gm.sample(helicoid, normals=normals)
    places = np.column_stack([usual.normal_index, usual.uv.round(6)])
    assert len(np.unique(places, axis=0)) == len(usual)
    of_nets = gm.sample(gm.Spline.from_nets(helicoid.control_nets), normals=normals)
    for name in ("normal_index", "component"):
        np.testing.assert_array_equal(getattr(of_nets, name), getattr(usual, name))
    monkeypatch.setattr(exact, "SAME_PLACE", apart)
    same(gm.sample(helicoid, normals=normals), usual)
    monkeypatch.setattr(exact, "SAME_PLACE", 0.0)
    assert len(search.find(helicoid, normals)) > len(usual)


# --- the same samples in the same order -----------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "sphere", "moebius_band", "wavy_graph"])
def test_any_number_of_threads_gives_the_same_bits(name, monkeypatch):
    """More normals and samples than go into one range; normals on symmetry planes among them."""
    monkeypatch.setattr(search, "RANGE", 500)
    monkeypatch.setattr(fill, "SAMPLES_AT_A_TIME", 333)
    surface = gm.surfaces.surface(name)
    asked: dict[str, Any]
    for asked in ({"normals": gm.icosphere(24)}, {"count": 2000}):
        first, *others = (
            gm.sample(surface, cells=(40, 30), threads=threads, **asked) for threads in (1, 2, 3, 7)
        )
        assert len(first) > 600
        for other in others:
            assert other.report == first.report
            same(other, first)


@pytest.mark.parametrize("threads", [1, 2, 3, 7])
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band", "sphere"])
@pytest.mark.quick_for("torus", "sphere")
def test_chunks_make_the_whole(name, threads, monkeypatch):
    monkeypatch.setattr(search, "RANGE", 64)
    monkeypatch.setattr(search, "NORMALS_AT_A_TIME", 500)
    spline = gm.fit(name, (20, 16))
    questions: list[dict[str, Any]] = [{"normals": gm.icosphere(12)}, {"count": 900}]
    for asked in questions:
        whole = gm.sample(spline, density="gauss", threads=1, **asked)
        for size in (7, 100, len(whole), 10**9):
            chunks = gm.sample_stream(spline, chunk=size, threads=threads, **asked)
            same_chunks(chunks, whole, size)


# --- the end --------------------------------------------------------------------------------------


@pytest.mark.parametrize("threads", [1, 2])
def test_closing_ends_the_work(threads, monkeypatch):
    monkeypatch.setattr(search, "RANGE", 4)
    gm.sample(SPLINE, normals=gm.icosphere(8), threads=threads)  # its threads are kept
    monkeypatch.setattr(search, "NORMALS_AT_A_TIME", 8)
    searched = []
    kernel = search.search

    def recorded(*arguments):
        searched.append(1)
        return kernel(*arguments)

    monkeypatch.setattr(search, "search", recorded)
    before = threading.active_count()
    chunks = gm.sample_stream(SPLINE, normals=gm.icosphere(8), chunk=5, threads=threads)
    next(chunks)
    chunks.close()
    assert len(searched) < len(gm.icosphere(8)) / 8 / 4
    assert threading.active_count() == before
    # and without a word of farewell
    chunks = gm.sample_stream(SPLINE, normals=gm.icosphere(8), chunk=5, threads=threads)
    next(chunks)
    del chunks
    gc.collect()
    assert threading.active_count() == before


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, MemoryError])
def test_an_error_ends_the_work(threads, error, monkeypatch):
    monkeypatch.setattr(search, "RANGE", 4)
    gm.sample(SPLINE, normals=gm.icosphere(8), threads=threads)  # its threads are kept
    kernel = search.search

    def failing(*arguments):
        if arguments[5] == 100:  # the first normal of a range
            raise error("one hundred")
        return kernel(*arguments)

    monkeypatch.setattr(search, "search", failing)
    before = threading.active_count()
    with pytest.raises(error, match="one hundred"):
        list(gm.sample_stream(SPLINE, normals=gm.icosphere(8), chunk=5, threads=threads))
    assert threading.active_count() == before
