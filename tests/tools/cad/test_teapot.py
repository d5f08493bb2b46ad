"""Newell's teapot as a part: 32 patches that are sewn, with the borders that it really has."""

from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from .made import bezier

QUARTER = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
MIRROR = np.diag([1.0, -1.0, 1.0])


def patches() -> list[gm.Surface]:
    text = (Path(__file__).parent / "teapot.txt").read_text(encoding="utf-8")
    lines = [x for x in text.splitlines() if not x.startswith("#")]
    found = []
    for k in range(0, len(lines), 5):
        points = np.array([x.split() for x in lines[k + 1 : k + 5]], dtype=np.float64)
        points = points.reshape(4, 4, 3).swapaxes(0, 1)  # so that normals of the body point outward
        copies = 2 if lines[k] in ("handle", "spout") else 4
        for turn in range(copies):
            matrix = np.linalg.matrix_power(MIRROR if copies == 2 else QUARTER, turn)
            found.append(bezier(points @ matrix.T, name=lines[k]))
    return found


def open_edges(part) -> dict[str, int]:
    """Return how many edges of faces with each name have no other face."""
    starts, found = part.arrays["edge_side_starts"], dict[str, int]()
    single = (np.diff(starts) == 1) & ~part.arrays["edge_degenerate"]
    for face in part.arrays["side_faces"][starts[:-1][single]].tolist():
        name = part.faces[face].name
        found[name] = found.get(name, 0) + 1
    return found


@pytest.fixture(scope="module")
def teapot():
    return gm.Part(patches(), tolerance=3e-3, name="teapot")


def test_body_and_bottom_lid_handle_and_spout_are_sewn(teapot):
    """The lid lies inside of the rim; handle and spout begin inside of the body."""
    assert (len(teapot), teapot.closed, teapot.oriented) == (32, False, False)
    assert teapot.gap < 1e-14
    assert open_edges(teapot) == {"rim": 4, "lid": 4, "handle": 4, "spout": 4}
    assert teapot.warnings == ("4 surfaces are flipped: 25, 27, 29, 31.",)
    np.testing.assert_allclose(teapot.bounds[1], [3.434075, 2.0, 3.15], atol=1e-6)


def test_the_tip_of_the_lid_is_no_point(teapot):
    """Its four patches end in loops of 0.002, which a small tolerance does not take for points."""
    part = gm.Part([x for x in patches() if x.name == "lid"])
    assert open_edges(part) == {"lid": 8}
    assert int(part.arrays["edge_degenerate"].sum()) == 0
    assert int(teapot.arrays["edge_degenerate"].sum()) == 8  # those of the bottom, too


@pytest.mark.slow
def test_it_is_sampled_and_meshed(teapot):
    samples = gm.sample(teapot, 3000)
    faces = np.asarray(samples.face_index).tolist()
    assert set(faces) == set(range(32))
    rows = [teapot.faces[k].name == "body" for k in faces]
    away = np.einsum("kx,kx->k", samples.normals[rows, :2], samples.points[rows, :2])
    assert (away > 0.0).all()
    mesh: Any = samples.mesh()
    assert (len(mesh.vertices), mesh.failed, mesh.closed) == (3000, {}, False)
    # A body, a lid, and two tubes, one of which touches a corner of the body.
    assert mesh.euler_characteristic == 1
