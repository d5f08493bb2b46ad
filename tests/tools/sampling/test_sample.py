"""From a surface to its samples: how many, where, in which order, and what is said about it."""

import math
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.sampling import stream

from ...refusals import refused
from ...shapes import BROKEN, TORUS, moved, same

DEVELOPABLE = ("plane", "cylinder", "cone")
CURVED = [name for name in gm.surfaces.names() if name not in DEVELOPABLE]
# The corners of the triangles south, east, north, west of a cell, from its centre.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2


# --- how many -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CURVED)
def test_count(name):
    spline = gm.fit(gm.surfaces.surface(name))
    for count in (300, 2000, 10_000):
        samples = gm.sample(spline, count=count, density="gauss")
        assert abs(len(samples) - count) <= 0.05 * count + 1
        assert samples.report.samples == len(samples)
        assert samples.report.developable_share == 0.0


@pytest.mark.parametrize("name", CURVED)
@pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")
@pytest.mark.quick_for("torus", "sphere", "moebius_band", "wavy_graph")
def test_small_counts(name):
    """A symmetric surface has not every number, but nothing far from it."""
    spline = gm.fit(gm.surfaces.surface(name))
    for count in (1, 2, 10):
        assert abs(len(gm.sample(spline, count=count, density="gauss")) - count) <= 8


# A graph so flat that its normals fill 10⁻⁶ of the sphere: the lattice is cut to them.
DISH = gm.surfaces.elliptic_paraboloid(a=30.0, b=40.0)
HARD = [
    *((moved(gm.surfaces.surface(name), x, 10.0 * x), (24, 24), 100)
      for name in ("wavy_graph", "torus") for x in (1e-12, 1e12, 1e-200, 1e200)),
    # On so few cells the quadrature of the solid angle, the first guess, is 6 to 12 % off.
    *((gm.surfaces.moebius_band(), cells, 40) for cells in ((4, 4), (5, 4), (6, 5))),
    (DISH, (24, 24), 100), (moved(DISH, 1e6), (24, 24), 100),
]  # fmt: skip


@pytest.mark.parametrize(("surface", "cells", "off"), HARD)
def test_count_where_it_is_hard_to_meet(surface, cells, off):
    samples = gm.sample(surface, count=2000, density="gauss", cells=cells)
    assert abs(len(samples) - 2000) <= off


def test_count_is_not_met_and_said_so():
    """A ribbon round a great circle: the Gaussian image is too thin for a hundredfold lattice."""
    ribbon = gm.Surface.from_callable(
        lambda u, v: np.stack(
            [(1 - 1e-6 * v * v) * np.cos(u), (1 - 1e-6 * v * v) * np.sin(u), v], axis=-1
        ),
        ((0, 2 * np.pi), (-1, 1)),
        (True, False),
    )
    with pytest.warns(gm.GaussmapWarning, match=r"\d+ samples instead of the requested 500"):
        samples = gm.sample(ribbon, count=500, density="gauss", cells=(64, 16))
    assert len(samples) < 450


@pytest.mark.parametrize("count", [0, -5, 1.0, True, np.nan, "10", [10]])
def test_counts_that_are_none(count):
    calls = [
        lambda: gm.sample(TORUS, count=count),
        lambda: gm.sample(BROKEN, count=count),  # before the surface is looked at
        lambda: next(gm.sample_many([TORUS], count=count)),
    ]
    for call in calls:
        refused("count must be a whole number of at least 1, not", call)


def test_normals_or_a_count_or_an_angle_or_a_coverage():
    amounts = {"normals": [[0, 0, 1]], "count": 5, "angle": 3.0, "coverage": 0.1}
    pairs = [("normals", "count"), ("normals", "angle"), ("count", "angle")]
    for asked in ({}, *({x: amounts[x] for x in pair} for pair in pairs), amounts):
        for call in (gm.sample, lambda x, **asked: next(gm.sample_many([x], **asked))):
            said = refused("say how many samples by one of normals,", call, BROKEN, **asked)
            assert ("none is given" in said) == (not asked)
            assert all(name in said.split(";")[1] for name in asked)


def test_cells_are_for_surfaces():
    spline = gm.fit(TORUS, (4, 4))
    refused("this spline already has its cells", gm.sample, spline, count=5, cells=(4, 4))
    assert gm.sample(spline, count=50).report.patches == 64
    assert gm.sample(TORUS, count=50, cells=(5, 4)).report.patches == 80


# --- what is flat ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DEVELOPABLE)
def test_developable_surfaces_are_warned_of(name):
    surface = gm.surfaces.surface(name)
    why = rf"surface '{name}': 100 % of its area is flat or developable \(K = 0\), which no set"
    with pytest.warns(gm.GaussmapWarning, match=why) as caught:
        samples = gm.sample(surface, normals=gm.icosphere(8))
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert samples.report.developable_share == pytest.approx(1.0)
    with pytest.warns(gm.GaussmapWarning, match=why + ".* samples instead of the requested 500"):
        gm.sample(surface, count=500, density="gauss")


def test_normals_outside_the_gaussian_image_are_warned_of():
    with pytest.warns(gm.GaussmapWarning, match="none of the normals lies in its Gaussian image"):
        samples = gm.sample(
            gm.surfaces.wavy_graph(), normals=[[0, 0, -1], [1, 0, 0]], cells=(16, 16)
        )
    assert len(samples) == 0
    assert samples.points.shape == (0, 3)
    assert samples.report.normals == samples.report.proved == 2


def test_a_surface_whose_bending_is_lost_in_rounding_is_warned_of():
    wire = gm.surfaces.torus(minor=1e-14)
    with pytest.warns(gm.GaussmapWarning, match="developable up to the rounding"):
        samples = gm.sample(wire, 500, density="gauss", cells=(16, 16), on="spline")
    assert len(samples) == 0
    assert (
        len(gm.sample(gm.surfaces.torus(minor=1e-6), normals=gm.icosphere(8), cells=(16, 16)))
        > 1200
    )


def test_half_a_surface_is_flat():
    bent = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, 0.1 * np.maximum(u, 0) ** 3 * (1 + v * v)], axis=-1),
        ((-1, 1), (-1, 1)),
    )
    with pytest.warns(gm.GaussmapWarning, match="5[0-4] % of its area is flat") as caught:
        samples = gm.sample(bent, count=1000, density="gauss")
    assert "were asked" not in str(caught[0].message)
    assert (samples.uv[:, 0] > -0.05).all()


# --- what comes -----------------------------------------------------------------------------------

SURFACES = ["torus", "moebius_band", "wavy_graph", "dupin_cyclide", "catenoid", "enneper"]


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("cells", [(10, 7), (7, 12)])
def test_samples_answer_their_normals(name, cells):
    spline = gm.fit(gm.surfaces.surface(name), cells)
    normals = gm.fibonacci(700) @ np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2.0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    samples = gm.sample(spline, normals=normals)
    assert len(samples) > 100
    report = samples.report
    assert (report.surface, report.normals, report.samples) == (name, 700, len(samples))
    assert report.patches == spline.patches
    np.testing.assert_array_equal(samples.normals, normals[samples.normal_index])
    pairs = samples.normal_index * spline.patches + samples.arrays()["patch_index"]
    assert (np.diff(pairs) > 0).all()  # by normal, then by patch, and no pair twice
    np.testing.assert_allclose(
        samples.support, (samples.normals * samples.points).sum(axis=1), rtol=0, atol=4e-15
    )
    size = np.abs(spline.coefficients).max()
    at_uv = spline.evaluate(*samples.uv.T)
    np.testing.assert_allclose(samples.points, at_uv, rtol=0, atol=1e-13 * size)
    found = spline.normals(*samples.uv.T)
    np.testing.assert_allclose(np.cross(found, samples.normals), 0.0, rtol=0, atol=1e-9)
    assert ((found * samples.normals).sum(axis=1) > 0).all()
    assert_in_patches(samples, spline)
    assert_in_patches(gm.sample(spline, normals=gm.icosphere(10)), spline)


def assert_in_patches(samples, spline):
    """Check that parameters are in the triangles of patches, and in the domain."""
    patches, cells = samples.arrays()["patch_index"], spline.cells
    assert (patches >= 0).all()
    assert (patches < spline.patches).all()
    place = (samples.uv - spline.frame[:2]) / spline.frame[2:]
    cell, turn = np.divmod(patches, 4)
    local = place - np.stack(np.divmod(cell, cells[1]), axis=1) - 0.5
    matrices = np.stack([CORNERS[turn], CORNERS[turn + 1]], axis=-1)
    weights = np.linalg.solve(matrices, local[..., None])[..., 0]
    assert weights.min() > -1e-12
    assert weights.sum(axis=1).max() < 1 + 1e-12
    low, high = np.array(spline.domain).T
    assert (samples.uv >= low - 1e-12).all()
    assert (samples.uv <= high + 1e-12).all()


@pytest.mark.parametrize("factor", [1.0, 2.0**-900, 0.3, 1e-300, 1e300])
def test_samples_of_lists_of_normals_of_any_length(factor):
    several = gm.sample(TORUS, normals=[[0, 0, 1], [factor, 0, 0], [0, 1, 1]], cells=(16, 16))
    assert np.bincount(several.normal_index).tolist()[1:] == [2, 2]
    single = gm.sample(TORUS, normals=((factor, 2 * factor, 3 * factor),), cells=(16, 16))
    normal = np.array([1, 2, 3]) / math.sqrt(14)
    np.testing.assert_allclose(single.normals, [normal] * 2, rtol=1e-15)


@pytest.mark.parametrize("count", [None, 500])
def test_arrays_and_surfaces_are_left_alone(count):
    normals = np.array([[0.0, 0.0, 2.0], [0.0, 3.0, 0.0], [1.0, 1.0, 1.0]])
    normals.setflags(write=False)
    spline = gm.fit(TORUS, (8, 8))
    asked: dict[str, Any] = {"count": count} if count else {"normals": normals}
    before = spline.coefficients.copy()
    samples, again = (gm.sample(spline, **asked) for _ in range(2))
    samples.points[:] = 0.0
    samples.normals[:] = 0.0
    assert np.abs(again.points).max() > 1.0
    np.testing.assert_array_equal(gm.sample(spline, **asked).points, again.points)
    assert (spline.coefficients == before).all()


# --- density --------------------------------------------------------------------------------------


def solid_angles_and_areas(surface, bins):
    """Return ∫|K| dA and ∫dA over bins × bins rectangles, by the midpoint rule, up to a factor."""
    fine = 40
    middles = (np.arange(bins * fine) + 0.5) / (bins * fine)
    places = (low + (high - low) * middles for low, high in surface.domain)
    uv = [x.ravel() for x in np.meshgrid(*places, indexing="ij")]
    _, x_u, x_v, *second = np.moveaxis(surface.jets(*uv), 1, 0)
    normal = np.cross(x_u, x_v)
    element = np.linalg.norm(normal, axis=1)
    L, M, N = (np.einsum("kx,kx->k", normal, x) for x in second)
    return [
        values.reshape(bins, fine, bins, fine).sum(axis=(1, 3))
        for values in (np.abs(L * N - M * M) / element**3, element)
    ]


@pytest.mark.parametrize("name", ["ellipsoid", "wavy_graph", "moebius_band", "torus"])
def test_density_is_gaussian_curvature(name):
    """Counts follow ∫|K| dA closer than independent samples would, and do not follow area."""
    bins, surface = 8, gm.surfaces.surface(name)
    samples = gm.sample(surface, count=20_000, density="gauss", cells=(96, 96))
    low, high = np.array(surface.domain).T
    place = np.clip((bins * (samples.uv - low) / (high - low)).astype(int), 0, bins - 1)
    counts = np.zeros((bins, bins))
    np.add.at(counts, tuple(place.T), 1)
    by_curvature, by_area = (
        x * len(samples) / x.sum() for x in solid_angles_and_areas(surface, bins)
    )
    chi_square = ((counts - by_curvature) ** 2 / np.maximum(by_curvature, 1)).sum()
    assert chi_square < bins**2
    assert ((counts - by_area) ** 2 / by_area).sum() > 20 * bins**2


# --- streams --------------------------------------------------------------------------------------

SPLINE = gm.fit(gm.surfaces.torus(), (12, 8))


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
        chunks = gm.sample_stream(SPLINE, chunk=37, threads=threads, **options)
        same(gm.Samples.concatenate(chunks), gm.sample(SPLINE, **options))


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
    whole = gm.sample(SPLINE, density="gauss", **asked)
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", size)
    chunks = list(gm.sample_stream(SPLINE, chunk=50, **asked))
    assert max(map(len, chunks)) <= 50
    joined = gm.Samples.concatenate(chunks)
    same(joined, whole)
    assert joined.report.normals == whole.report.normals


def test_normals_may_be_changed_before_the_last_chunk(monkeypatch):
    monkeypatch.setattr(stream, "NORMALS_AT_A_TIME", 40)
    normals = gm.fibonacci(200)
    whole = gm.Samples.concatenate(gm.sample_stream(SPLINE, normals=normals, chunk=20))
    chunks = gm.sample_stream(SPLINE, normals=normals, chunk=20)
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
    chunks = list(gm.sample_stream(SPLINE, normals=gm.icosphere(4), chunk=50))
    for chunk in chunks:
        assert chunk.report.samples == len(chunk)
        assert chunk.report.developable_patches is None
        assert (chunk.report.normals, chunk.report.patches) == (162, SPLINE.patches)
    used = len(set(chunks[0].normal_index.tolist()))
    assert f"50 samples at {used} of 162 prescribed normals" in chunks[0].summary()


@pytest.mark.parametrize(
    "asked",
    [{}, {"count": 5, "normals": [[0, 0, 1]]}, {"count": 0}, {"normals": [[0, 0, 0]]},
     *({"count": 5, "chunk": x} for x in (0, 2.5, "many")),
     {"count": 5, "threads": 0}, {"count": 5, "cells": (4, 4)}],
)  # fmt: skip
def test_errors_come_at_once(asked):
    refused("", gm.sample_stream, SPLINE, **asked)
    refused("", gm.sample_stream, BROKEN, 5, error=gm.errors.SurfaceError)


# --- at once --------------------------------------------------------------------------------------


def test_streams_in_several_python_threads():
    whole = gm.sample(SPLINE, normals=gm.icosphere(8))
    narrow = gm.sample(SPLINE, normals=gm.icosphere(8), fields=("points",), dtype=np.float32)
    start = threading.Barrier(6, timeout=30)

    def work(k):
        options = {"fields": ("points",), "dtype": np.float32} if k % 2 else {}
        options |= {"chunk": 100 + k, "threads": 1 + k % 3}
        start.wait()
        return gm.Samples.concatenate(gm.sample_stream(SPLINE, normals=gm.icosphere(8), **options))

    with ThreadPoolExecutor(6) as pool:
        for k, samples in enumerate(pool.map(work, range(6))):
            same(samples, narrow if k % 2 else whole)


def test_streams_may_be_interleaved():
    first = gm.sample_stream(SPLINE, normals=gm.icosphere(6), chunk=20)
    second = gm.sample_stream(QUARTER, normals=gm.icosphere(6), chunk=7)
    parts = [one for one, _ in zip(first, second, strict=False)]
    assert len(parts) > 3
    same(
        gm.Samples.concatenate(parts), gm.sample(SPLINE, normals=gm.icosphere(6))[: 20 * len(parts)]
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
