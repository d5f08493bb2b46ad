"""Samples on the sharp edges of parts made of numbers."""

# pyright: reportArgumentType=false, reportCallIssue=false
# pyright: reportAttributeAccessIssue=false

import itertools
from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import box, box_edges, box_faces
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import EdgeRecord
from scipy.spatial import cKDTree

from ...refusals import refused
from ...shapes import same
from .made import CYLINDER, FAILED, face, is_on, part, placement

SIZES = np.array([1.0, 2.0, 3.0])


def on_edges(samples: gm.Samples) -> gm.Samples:
    return samples[samples.kind == "edge"]


def pairs_of(samples: gm.Samples) -> set[tuple[int, int]]:
    return set(zip(samples.face_index, samples.other_face_index, strict=True))


def both_ways(samples: gm.Samples, part: Part) -> None:
    """Compare samples on edges with both faces at their own parameters."""
    for points, normals, uv, faces in (
        (samples.points, samples.normals, samples.uv, samples.face_index),
        (samples.points, samples.other_normals, samples.other_uv, samples.other_face_index),
    ):
        for k in np.unique(faces):
            rows = faces == k
            is_on(part.faces[k].surface, uv[rows], points[rows], normals[rows])


@pytest.mark.parametrize(
    "request_",
    [{"count": 60}, {"count": 60, "density": "uniform"}, {"coverage": 0.8}, {"angle": 30}],
)
def test_box(request_):
    samples, without = (gm.sample(box(*SIZES), **request_, edges=x) for x in (True, False))
    count = len(without)
    for name, array in without.arrays().items():
        assert np.array_equal(array, getattr(samples, name)[:count])
    assert samples.report.edge_samples == len(samples) - count
    assert samples.report == replace(
        without.report, samples=len(samples), edge_samples=len(samples) - count
    )
    edge = samples[count:]
    assert set(samples.kind[:count]) == {"filling"}
    assert set(edge.kind) == {"edge"}
    at_border = (edge.points == 0.0) | (edge.points == SIZES)
    assert (at_border.sum(axis=1) >= 2).all()
    assert (at_border.sum(axis=1) == 3).sum() == 8  # one sample a corner
    assert len(np.unique(edge.points, axis=0)) == len(edge)
    both_ways(edge, box(*SIZES))
    assert pairs_of(edge) == {x.faces for x in box_edges(*SIZES)}
    assert f"; {len(edge)} of the samples are on sharp edges" in samples.summary()
    assert np.isnan(samples.other_normals[:count]).all()
    assert np.isnan(samples.other_uv[:count]).all()
    assert (samples.other_face_index[:count] == -1).all()


def test_edges_are_as_dense_as_the_faces():
    for count in (60, 600):
        samples = gm.sample(box(1.0, 1.0, 1.0), count, edges=True)
        # The neighbours of a hexagonal lattice of as many samples are so far apart.
        wanted = np.sqrt(2.0 / np.sqrt(3.0) * 6.0 / count)
        assert samples.report.edge_samples == 8 + 12 * (np.ceil(1.0 / wanted) - 1)


def test_circles_are_exact_though_the_file_has_few_points():
    samples = gm.sample(CYLINDER, 200, edges=True)
    edge = on_edges(samples)
    np.testing.assert_allclose(np.hypot(*edge.points[:, :2].T), 1.0, atol=1e-14)
    both_ways(edge, CYLINDER)
    assert set(edge.face_index) == {0}
    for k, z in ((1, 0.0), (2, 2.0)):
        ring = edge[edge.other_face_index == k]
        assert np.abs(ring.points[:, 2] - z).max() < 1e-14
        # Around the circle normals turn as much as between neighbours elsewhere.
        steps = np.diff(np.sort(np.arctan2(ring.points[:, 1], ring.points[:, 0])))
        assert steps.max() < 1.05 * steps.min()
        near = cKDTree(samples.points[samples.kind != "edge"]).query(ring.points)[0]
        assert 0.5 < np.median(2.0 * near) / np.median(steps) < 2.0


def test_weights_are_those_of_the_others():
    samples = gm.sample(CYLINDER, 100, edges=True)
    weights = samples.weights()
    assert (weights[samples.kind == "edge"] == 0.0).all()
    assert weights.sum() == pytest.approx(CYLINDER.area, rel=1e-12)
    assert samples.coverage() <= gm.sample(CYLINDER, 100).coverage()


@pytest.mark.parametrize("density", [0.5, 8.0])
def test_powers_of_the_curvature(density):
    samples = gm.sample(CYLINDER, 100, density=density, edges=True)
    assert 4 <= samples.report.edge_samples < 200


def test_edges_have_samples_where_faces_have_none():
    with pytest.warns(gm.GaussmapWarning, match="100 % of its area is flat"):
        samples = gm.sample(box(), normals=[[1.0, 1, 1]], edges=True)
    assert set(samples.kind) == {"edge"}
    # The corners, and the middles of the edges.
    places = (2.0 * samples.points / SIZES).tolist()
    assert sorted(map(tuple, places)) == sorted(
        x for x in itertools.product((0.0, 1.0, 2.0), repeat=3) if x.count(1.0) < 2
    )


def test_no_edges():
    samples = gm.sample(part(box_faces()), 20, edges=True)
    assert len(samples) == 20
    assert samples.report.edge_samples == 0
    assert set(samples.kind) == {"filling"}
    assert samples.other_normals.shape == (20, 3)


def test_gaps_of_the_file_are_closed_and_wide_ones_have_no_samples():
    edges, on_second = box_edges(*SIZES), np.array([0.0, 0.0, 1.0, 1.0])
    edges[0] = replace(edges[0], parameters=edges[0].parameters + 1e-6 * on_second)
    edges[1] = replace(edges[1], parameters=edges[1].parameters + 0.1 * on_second)
    edge = on_edges(gm.sample(part(box_faces(*SIZES), edges=edges), 60, edges=True))
    both_ways(edge, box(*SIZES))
    assert edges[0].faces in pairs_of(edge)
    assert edges[1].faces not in pairs_of(edge)


@pytest.mark.parametrize(("angle", "sharp"), [(0.9, False), (1.1, True)])
def test_tangent_faces_have_no_sharp_edge(angle, sharp):
    """A plane that goes on in a quarter of a cylinder, and meets another plane at an angle."""
    below = placement((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    slope = np.radians(angle)
    along = (np.cos(slope), 0.0, np.sin(slope))
    faces = [
        face("plane", u=(-1.0, 0.0)),
        face("cylinder", 1.0, u=(0.0, np.pi / 2), place=below),
        face("plane", place=placement(z=(-along[2], 0.0, along[0]), x=along)),
    ]
    edges = [EdgeRecord((0, k), np.array([(0.0, x, 0.0, x) for x in (0.0, 1.0)])) for k in (1, 2)]
    samples = gm.sample(part(faces, edges=edges), 30, edges=True)
    assert (samples.report.edge_samples > 0) == sharp
    assert {tuple(sorted(x)) for x in pairs_of(on_edges(samples))} == ({(0, 2)} if sharp else set())


def test_failed_faces_and_bad_numbers_cost_their_edges():
    faces, edges = box_faces(*SIZES), box_edges(*SIZES)
    faces[0] = FAILED
    last = next(k for k, x in enumerate(edges) if x.faces == (3, 5))
    edges[last] = EdgeRecord((3, 5), np.full((2, 4), np.nan))
    with pytest.warns(gm.GaussmapWarning, match="1 of 6 faces"):
        edge = on_edges(gm.sample(part(faces, edges=edges), 40, edges=True))
    assert pairs_of(edge) == {x.faces for x in edges if 0 not in x.faces and x.faces != (3, 5)}


def test_corners_of_solids_that_touch_are_two():
    faces, edges = box_faces(*SIZES), box_edges(*SIZES)
    faces += [replace(x, solid_index=1) for x in faces]
    edges += [EdgeRecord((x.faces[0] + 6, x.faces[1] + 6), x.parameters) for x in edges]
    edge = on_edges(gm.sample(part(faces, edges=edges), 4, edges=True))
    corners = ((edge.points == 0.0) | (edge.points == SIZES)).all(axis=1)
    assert np.bincount(edge.solid_index[corners]).tolist() == [8, 8]


def test_threads_give_the_same():
    same(*(gm.sample(CYLINDER, 80, threads=x, edges=True) for x in (1, 3)))


def test_some_fields(tmp_path):
    chosen = gm.sample(box(), 30, edges=True, fields=("other_normals",), dtype=np.float32)
    assert chosen.fields == ("other_normals",)
    assert chosen.dtype == np.float32
    few = gm.sample(box(), 30, edges=True, fields=("points", "other_face_index"))
    few.write(tmp_path / "few.csv")
    lines = (tmp_path / "few.csv").read_text().splitlines()
    assert lines[0] == "x [mm],y [mm],z [mm],other_face_index"
    assert len(lines) == 1 + len(few)


@pytest.mark.parametrize(
    ("surface", "arguments", "match"),
    [
        ("torus", {"edges": True}, "of CAD parts"),
        (box(), {"fields": ("other_uv",)}, "with samples on edges only"),
        (box(), {"edges": np.zeros(3)}, "edges must be True or False"),
    ],
)
def test_unusable_arguments(surface, arguments, match):
    refused(match, gm.sample, surface, 10, **arguments)
