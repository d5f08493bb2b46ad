"""The index of a spline: cones hold all normals, and the search finds what exact decisions do."""

import pickle
import threading
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search import exact, patch_index, search
from gaussmap.runtime.search.lines import meeting
from gaussmap.runtime.search.patch_index import Index, index_of
from gaussmap.runtime.search.search import Hits, find
from hypothesis import given
from hypothesis import strategies as st

from ...nets import bezier
from ...products import covering
from ...shapes import AXES, Array, unit

NORMALS = np.concatenate([gm.fibonacci(60), AXES])
OPEN = ("open", "open")


def crumpled(seed: int) -> gm.Spline:
    """Return a spline whose patches have wide cones, or none."""
    values = np.random.default_rng(seed).normal(size=(9, 7, 3))
    return gm.Spline(values, ((0.0, 1.0), (0.0, 1.0)), (OPEN, OPEN), "crumpled")


def waves(height: float) -> gm.Spline:
    """Return a graph whose normals lie in a cap of about this radius."""
    surface = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, height * np.sin(u) * np.cos(v)], axis=-1),
        domain=((0.0, 2 * np.pi), (0.0, 2 * np.pi)),
    )
    return gm.fit(surface, (9, 8))


SPLINES = {
    "torus": gm.fit("torus", (24, 17)),
    "sphere": gm.fit("sphere", (9, 16)),
    "moebius_band": gm.fit("moebius_band", (33, 5)),
    "few cells": gm.fit("wavy_graph", (3, 4)),
    "flat": gm.fit("plane", (8, 8)),
    "crumpled": crumpled(1),
    "crumpled again": crumpled(2),
    "waves": waves(1e-3),
    "ripples": waves(1e-7),
}


def asked(spline: gm.Spline) -> Array:
    """Return normals all over the sphere, and some of the spline, at its corners too."""
    (u0, u1), (v0, v1) = spline.domain
    rng = np.random.default_rng(3)
    u, v = rng.uniform(u0, u1, 12), rng.uniform(v0, v1, 12)
    u, v = np.append(u, np.linspace(u0, u1, 4)), np.append(v, np.linspace(v0, v1, 4))
    own = spline.normals(u, v)
    own = own[np.linalg.norm(own, axis=1) > 0.5]
    return np.concatenate([NORMALS, own, -own[:2]])


def every(spline: gm.Spline, normals: Array) -> Hits:
    """Return all hits, by exact decisions on all pairs of a patch and a normal."""
    patches, numbers = (
        x.ravel() for x in np.indices((spline.patches, len(normals)), dtype=np.int64)
    )
    local, _, _ = exact.decided_forms(spline, patches, normals[numbers], None)
    with np.errstate(invalid="ignore"):
        near = (local > -1e-3).all(axis=1) & (local.sum(axis=1) < 1.0 + 1e-3)
    patches, numbers = patches[near], numbers[near]
    bounds = index_of(spline, 1).bounds
    forgiven = np.where(search.on_border(spline, patches), bounds[patches], 0.0)
    decision = exact.decide(spline, patches, normals[numbers], numbers, forgiven)
    keys = numbers[decision.which] << 32 | patches[decision.which]
    order = np.argsort(keys)
    return Hits(keys[order], np.arange(len(keys)), decision.local[order], 0)


def check_hits(spline: gm.Spline, normals: Array) -> Hits:
    """Assert that the hits are those of exact decisions, but at components of several hits."""
    found, exactly = find(spline, normals, components=True), every(spline, normals)
    several = np.concatenate([found.normal_index[found.special], meeting(spline, exactly)])
    one, other = (x.keys[~np.isin(x.normal_index, several)] for x in (found, exactly))
    np.testing.assert_array_equal(one, other)
    return found


@pytest.mark.parametrize("name", SPLINES)
def test_hits_are_those_of_exact_decisions(name: str) -> None:
    """They come by normal and then by patch."""
    found = check_hits(SPLINES[name], asked(SPLINES[name]))
    assert (len(found.special) > 0) == (name in ("torus", "few cells", "flat"))


@given(seed=st.integers(0, 2**32 - 1), roughness=st.floats(-8, 1))
def test_rough_splines(seed: int, roughness: float) -> None:
    """From gentle waves to patches with normals all round: cones of every width."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 6), indexing="ij")
    heights = 10.0**roughness * rng.standard_normal(u.shape)
    points = np.stack([u, v, heights], axis=-1) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
    spline = gm.Spline(points, ((0, 5), (0, 4)), (OPEN, OPEN), "rough")
    check_hits(spline, asked(spline))


def normals_of(spline: gm.Spline) -> Array:
    """Return normals (patches, k, 3) at places of each patch, from its control net."""
    inside = np.random.default_rng(0).dirichlet([0.5] * 3, 20)
    corners = (1.0 - 3e-6) * np.eye(3) + 1e-6  # not of collapsed sides, where lengths vanish
    places = np.concatenate([inside, corners])
    return unit(np.cross(*bezier(spline.control_nets[:, None], places)[1:]))


@pytest.mark.parametrize("name", SPLINES)
def test_cones_and_slabs_hold_all_normals(name: str) -> None:
    """But for the rounding of the normals of this test, which is that of the control points."""
    spline = SPLINES[name]
    axes, chords, slabs, widths = np.split(index_of(spline, 1).pieces.cones, [3, 4, 7], axis=1)
    normals = normals_of(spline)
    assert (np.linalg.norm(normals - axes[:, None], axis=2) <= chords + 1e-12).all()
    assert (np.abs(np.einsum("pkx,px->pk", normals, slabs)) <= widths + 1e-12).all()


def test_cones_are_narrow() -> None:
    """Cones and slabs of patches are about as wide as the turn of the normal across them.

    Those at poles are, too, although a control normal vanishes there.
    """
    cones = index_of(gm.fit("torus", (64, 64)), 1).pieces.cones
    assert np.median(cones[:, 3]) < 1.2 * np.pi / 64
    assert np.median(cones[:, 7]) < 0.7 * np.pi / 64
    sphere = gm.fit("sphere", (64, 64))
    assert index_of(sphere, 1).pieces.cones[:, 3].max() < 2 * np.hypot(np.pi, np.pi) / 64


@pytest.mark.parametrize("name", ["torus", "waves", "ripples"])
def test_normals_are_compared_with_few_patches(name: str) -> None:
    """Also if all normals of the spline crowd in a small cap."""
    spline = SPLINES[name]
    members = np.diff(index_of(spline, 1).lists.starts)
    assert (members**2).sum() / members.sum() < spline.patches / 3  # in the bin of a patch
    assert members.sum() < 12 * spline.patches


# Sizes of parts of the work.
SIZES: dict[str, list[tuple[Any, str, float]]] = {
    "wide bins": [(patch_index, "BINS_PER_PIECE", 2.0)],
    "narrow bins": [(patch_index, "BINS_PER_PIECE", 30.0)],
    "no caps": [(patch_index, "WIDEST_CAP", 0.0)],
    "no room for hits": [(search, "ROOM", 1)],
    "parts of the spline": [(patch_index, "MOST_PATCHES", 100), (search, "MOST_PATCHES", 100)],
    "few hits": [(search, "MOST_HITS", 40), (search, "RANGE", 3)],
    "few pieces": [(search, "RANGE", 7), (patch_index, "PIECES_AT_A_TIME", 50)],
}


@covering(name=["torus", "moebius_band", "crumpled", "waves"], size=SIZES, threads=[1, 2, 5])
def test_sizes_and_threads_do_not_change_hits(
    name: str, size: str, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    spline, normals = pickle.loads(pickle.dumps(SPLINES[name])), asked(SPLINES[name])
    expected = find(SPLINES[name], normals, 1)
    for module, constant, value in SIZES[size]:
        monkeypatch.setattr(module, constant, value)
    parts = list(search.find_in_turn(spline, normals, threads))
    found = Hits.joined(parts)
    for array in ("keys", "exact", "local"):
        np.testing.assert_array_equal(getattr(found, array), getattr(expected, array))
    assert len(expected) > 4
    if size == "few hits":  # so that memory is bounded: one normal may have the most of all hits
        assert len(parts) > len(expected) / 40
    # Parts of a spline have an index each, which is not kept.
    assert (Index in vars(spline)["_kept"]) == (size != "parts of the spline")


def test_an_index_is_made_once_and_not_pickled(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    listed = patch_index.listed
    monkeypatch.setattr(patch_index, "listed", lambda cones: made.append(1) or listed(cones))
    for spline in (gm.fit("torus", (24, 17)), gm.Spline.from_nets(SPLINES["torus"].control_nets)):
        size = len(pickle.dumps(spline))
        first = gm.sample(spline, normals=AXES)
        asks = [threading.Thread(target=gm.sample, args=(spline,), kwargs={"normals": AXES})] * 1
        for ask in asks:
            ask.start()
            ask.join()
        second = gm.sample(spline, normals=AXES)
        assert first.points.tobytes() == second.points.tobytes()
        assert len(pickle.dumps(spline)) == size
        again = gm.sample(pickle.loads(pickle.dumps(spline)), normals=AXES)
        assert (again.uv == first.uv).all()
    assert len(made) == 4
