"""The tree of cones: the same hits as in the search of all patches, kept with the spline."""

import pickle

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search import cone_tree, search
from gaussmap.runtime.search.bins import NormalBins
from gaussmap.runtime.search.cone_tree import ConeTree
from gaussmap.runtime.search.search import Search, find
from numpy.typing import NDArray

Array = NDArray[np.float64]
AXES = np.concatenate([np.eye(3), -np.eye(3)])
NORMALS = np.concatenate([gm.fibonacci(60), AXES])


def crumpled(seed: int) -> gm.Spline:
    """Return a spline whose patches have wide cones, or none."""
    values = np.random.default_rng(seed).normal(size=(9, 7, 3))
    ends = ("open", "open")
    return gm.Spline(values, ((0.0, 1.0), (0.0, 1.0)), (ends, ends), "crumpled")


SPLINES = {
    "torus": gm.fit("torus", (24, 17)),
    "sphere": gm.fit("sphere", (9, 16)),
    "moebius_band": gm.fit("moebius_band", (33, 5)),
    "few cells": gm.fit("wavy_graph", (3, 4)),
    "flat": gm.fit("plane", (8, 8)),
    "crumpled": crumpled(1),
    "crumpled again": crumpled(2),
}


def tree_of(spline: gm.Spline) -> ConeTree:
    return ConeTree.of(Search(spline, NormalBins(NORMALS)).coefficients, None)


@pytest.mark.kernels
@pytest.mark.parametrize("name", SPLINES)
def test_hits_are_those_of_all_patches(name, monkeypatch):
    spline, found = SPLINES[name], []
    for share in (1 << 40, 0):  # in all patches, in the tree
        monkeypatch.setattr(search, "PATCHES_PER_NORMAL", share)
        found.append(find(spline, NormalBins(NORMALS)))
    every, few = found
    assert (every.patch_index == few.patch_index).all()
    assert (every.normal_index == few.normal_index).all()
    assert (every.exact_indices == few.exact_indices).all()
    assert every.developable == few.developable
    assert len(few) > 0 or name == "flat"


def normals_of(spline: gm.Spline) -> Array:
    """Return normals (patches, k, 3) at places of each patch, from its control net."""
    b200, b020, b002, b110, b101, b011 = np.moveaxis(spline.control_nets, 1, 0)
    along_u = np.stack([b200 - b101, b110 - b011, b101 - b002])
    along_v = np.stack([b110 - b101, b020 - b011, b011 - b002])
    inside = np.random.default_rng(0).dirichlet([0.5] * 3, 20)
    corners = (1.0 - 3e-6) * np.eye(3) + 1e-6  # not of collapsed sides, where lengths vanish
    places = np.concatenate([inside, corners])
    normals = np.cross(*(np.einsum("ki,ipx->pkx", places, x) for x in (along_u, along_v)))
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


@pytest.mark.parametrize("name", SPLINES)
def test_cones_hold_all_normals(name):
    spline = SPLINES[name]
    nodes, levels = (np.asarray(x, dtype=float) for x in tree_of(spline).tree[:2])
    normals = normals_of(spline)
    assert (
        np.einsum("pkx,px->pk", normals, nodes[: spline.patches, :3]).min(axis=1)
        >= nodes[: spline.patches, 3]
    ).all()
    here = normals.reshape(*spline.cells, -1, 3)
    for level, (start, rows, columns) in enumerate(levels.astype(int).tolist()):
        size = 2**level
        assert (rows, columns) == tuple(-(-x // size) for x in spline.cells)
        for i, j in np.ndindex(rows, columns):
            block = here[i * size : (i + 1) * size, j * size : (j + 1) * size]
            node = nodes[start + i * columns + j]
            assert (block @ node[:3] >= node[3]).all()


def test_cones_are_narrow():
    """Half-angles of cells are about half the turn of the normal across them."""
    tree = tree_of(gm.fit("torus", (64, 64)))
    cells = tree.tree.nodes[4 * 64**2 : 5 * 64**2, 3].astype(float)
    turn = np.arccos(np.clip(cells, -1.0, 1.0))
    assert np.median(turn) < 1.2 * np.hypot(np.pi, np.pi) / 64


def test_hits_without_room_are_searched_again(monkeypatch):
    spline = SPLINES["crumpled"]
    expected = tree_of(spline).search(NORMALS, 1)
    monkeypatch.setattr(cone_tree, "ROOM", 0)
    monkeypatch.setattr(cone_tree, "LEAST_ROOM", 4)
    found = tree_of(spline).search(NORMALS, 1)
    assert len(found[0]) > 4
    assert all((x == y).all() for x, y in zip(found, expected, strict=True))


@pytest.mark.parametrize("threads", [2, 5])
def test_threads_do_not_change_hits(threads, monkeypatch):
    monkeypatch.setattr(cone_tree, "NORMALS_AT_A_TIME", 7)
    tree = tree_of(SPLINES["torus"])
    one, other = tree.search(NORMALS, 1), tree.search(NORMALS, threads)
    assert all((x == y).all() for x, y in zip(one, other, strict=True))


def test_a_tree_is_made_once_and_not_pickled(monkeypatch):
    made = []
    of = ConeTree.of
    monkeypatch.setattr(ConeTree, "of", lambda *x: made.append(x) or of(*x))
    spline = gm.fit("torus", (24, 17))
    size = len(pickle.dumps(spline))
    first, second = (gm.sample(spline, normals=AXES) for _ in range(2))
    assert len(made) == 1
    assert first.points.tobytes() == second.points.tobytes()
    assert len(pickle.dumps(spline)) == size
    assert (gm.sample(pickle.loads(pickle.dumps(spline)), normals=AXES).uv == first.uv).all()
