"""Samples on sharp edges against what Open CASCADE says of both faces."""

# pyright: reportMissingImports=false
# pyright: reportArgumentType=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.edges import between_two, edges_of, sides_at
from gaussmap.tools.cad.faces import own_parameters
from gaussmap.tools.cad.results import space_of

from .shapes import SOLIDS, lie_on_faces

# Curves of intersection that Open CASCADE computed are borders within its default tolerance.
COMPUTED = ("cut ball", "as NURBS", "cone and cylinder", "crossed cylinders")


def tolerance_of(name: str) -> float:
    return 1e-7 if name in COMPUTED else 0.0


def sharp_edges(part):
    """Return the edges at which the normals of their faces differ somewhere."""
    edges = edges_of(space_of(part, None))
    found = []
    for k in range(len(edges)):
        places = np.linspace(0.0, np.diff(edges.starts)[k] - 1.0, 33)
        owner = np.full(len(places), k)
        sides = sides_at(edges.space, edges.pieces[owner], edges.at(owner, places))
        found += [k] * bool(sides.sharp.any())
    return found


@pytest.mark.parametrize("name", SOLIDS)
def test_samples_lie_on_both_faces(name, part_with):
    make, _, count = SOLIDS[name]
    part = part_with(make())
    samples = gm.sample(part, 40, edges=True)
    edge = samples[samples.kind == "edge"]
    sharp = sharp_edges(part)
    assert len(sharp) == count
    pairs = set(zip(edge.face_index, edge.other_face_index, strict=True))
    assert pairs == {tuple(between_two(part)[0][k]) for k in sharp}
    assert (samples.report.edge_samples > 0) == (count > 0)
    more = {"rows": samples.kind == "edge", "tolerance": tolerance_of(name)}
    for side in ("", "other_"):
        lie_on_faces(samples, part, make(), other=side, **more)


@pytest.mark.parametrize("name", SOLIDS)
def test_wires_close_and_lie_on_their_faces(name, part_with):
    """Each edge has the same points on all of its faces, and loops are those of wires."""
    part = part_with(SOLIDS[name][0]())
    arrays, size = part.arrays, np.linalg.norm(np.ptp(part.bounds, axis=0))
    owner = np.repeat(np.arange(len(arrays["edge_vertices"])), np.diff(arrays["edge_side_starts"]))
    assert sorted(arrays["wire_sides"].tolist()) == list(range(len(owner)))  # each side once
    tolerance = max(tolerance_of(name), 1e-9 * size)
    for face in part.faces:
        assert len(face.wires) == len(face.loops)
        for wire, loop in zip(face.wires, face.loops, strict=True):
            ends, area = [], 0.0
            for side, backwards in wire:
                first, last = arrays["side_point_starts"][side : side + 2]
                uv = arrays["side_points"][first:last, :2]
                points = uv[::-1] if backwards else uv
                nearest = np.linalg.norm(points[:, None] - loop, axis=2).min(axis=1)
                assert nearest[[0, -1]].max() <= 1e-9 * np.ptp(loop, axis=0).max()
                vertices = arrays["edge_vertices"][owner[side]]
                own = own_parameters(face.surface, uv[[0, -1]], is_reversed=face.reversed)
                low, high = np.array(face.surface.domain).T
                found = face.surface.jets(*np.clip(own, low, high).T.copy())[:, 0]
                assert np.abs(found - arrays["vertices"][vertices]).max() <= tolerance
                ends.append(vertices[::-1] if backwards else vertices)
                x, y = (points - loop[0]).T
                area += (x[:-1] * np.diff(y) - y[:-1] * np.diff(x)).sum() / 2.0
            assert all(x[1] == y[0] for x, y in zip(ends, [*ends[1:], ends[0]], strict=True))
            x, y = (loop - loop[0]).T
            wanted = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0
            assert area == pytest.approx(wanted, rel=0.05)  # the same way around
    degenerate = arrays["edge_vertices"][arrays["edge_degenerate"]]
    assert (degenerate[:, 0] == degenerate[:, 1]).all()
