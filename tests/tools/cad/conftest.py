"""Parts made of numbers, for tests without Open CASCADE."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gaussmap.tools.cad.examples import box_faces
from gaussmap.tools.cad.part import Part, part_of
from gaussmap.tools.cad.records import EdgeRecord, FaceRecord, Geometry, PartRecord

TURN = 2 * np.pi


def placement(origin=(0.0, 0.0, 0.0), z=(0.0, 0.0, 1.0), x=(1.0, 0.0, 0.0)) -> np.ndarray:
    return np.concatenate([origin, x, np.cross(z, x), z]).astype(np.float64)


def rectangle(u0: float, u1: float, v0: float, v1: float) -> np.ndarray:
    return np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])


def face(kind: str, numbers, u, v, area: float, periods=(0.0, 0.0), **more) -> FaceRecord:
    geometry = Geometry(kind, np.asarray(numbers, np.float64))
    given = {"domain": (u, v), "periods": periods, "loops": [rectangle(*u, *v)], **more}
    return FaceRecord(geometry, area=area, **given)


def cylinder_faces(radius: float = 1.0, height: float = 2.0) -> list[FaceRecord]:
    """Return the side and the two disks of a cylinder, normals outward."""
    turn = np.linspace(0.0, TURN, 1440, endpoint=False)
    circle = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    disk, ends = np.pi * radius**2, (-radius, radius)
    side = face(
        "cylinder",
        [*placement(), radius],
        (0.0, TURN),
        (0.0, height),
        TURN * radius * height,
        (TURN, 0.0),
        solid_index=0,
        color=(1.0, 0.5, 0.0),
    )
    return [side] + [
        face(
            "plane",
            placement((0.0, 0.0, z)),
            ends,
            ends,
            disk,
            loops=[circle],
            reversed=z == 0.0,
            solid_index=0,
        )
        for z in (0.0, height)
    ]


def side(places, slopes=None):
    """Return u and v (k, 2) of an edge on a face, or places (2, 2) of a straight one; see below."""
    places = np.asarray(places, np.float64)
    straight = np.tile(places[-1:] - places[:1], (len(places), 1))
    return places, straight if slopes is None else slopes


def edge(faces, sides, vertices, degenerate: bool = False) -> EdgeRecord:
    """Return an edge from what `side` returns for each of its faces."""
    places, slopes = (np.concatenate(x, axis=1) for x in zip(*sides, strict=True))
    return EdgeRecord(tuple(faces), places, slopes, vertices, degenerate)


def cylinder(radius: float = 1.0, height: float = 2.0, points: int = 9) -> Part:
    """Return a cylinder with its edges: two circles, of which there are few points, and a seam."""
    u = np.linspace(0.0, TURN, points)
    ring = radius * np.stack([np.cos(u), np.sin(u)], axis=1)
    slopes = TURN * np.stack([-ring[:, 1], ring[:, 0]], axis=1)
    edges = [
        edge(
            (0, k),
            [side(np.stack([u, np.full(points, z)], axis=1)), side(ring, slopes)],
            (k - 1,) * 2,
        )
        for k, z in ((1, 0.0), (2, height))
    ]
    seam = [side([(x, 0.0), (x, height)]) for x in (0.0, TURN)]
    edges.append(edge((0, 0), seam, (0, 1)))
    faces = cylinder_faces(radius, height)
    faces[0] = replace(faces[0], wires=[[(0, 0, False), (2, 1, False), (1, 0, True), (2, 0, True)]])
    faces[1:] = [replace(x, wires=[[(k, 1, False)]]) for k, x in enumerate(faces[1:])]
    vertices = np.array([(radius, 0.0, 0.0), (radius, 0.0, height)])
    return part(faces, "cylinder", edges=edges, vertices=vertices, solid_names=["one"])


def ball(radius: float = 1.0) -> Part:
    """Return a ball with its edges: a seam, and a degenerate one at each pole."""
    low, high = -TURN / 4, TURN / 4
    whole = face(
        "sphere", [*placement(), radius], (0.0, TURN), (low, high), 2.0 * TURN * radius**2,
        (TURN, 0.0), solid_index=0,
        wires=[[(0, 0, False), (2, 1, False), (1, 0, True), (2, 0, True)]],
    )  # fmt: skip
    edges = [
        *(
            edge((0,), [side([(0.0, v), (TURN, v)])], (k, k), True)
            for k, v in ((0, low), (1, high))
        ),
        edge((0, 0), [side([(u, low), (u, high)]) for u in (0.0, TURN)], (0, 1)),
    ]
    vertices = np.array([(0.0, 0.0, -radius), (0.0, 0.0, radius)])
    return part([whole], "ball", edges=edges, vertices=vertices, solid_names=["one"])


def part(faces, name: str = "part", oriented: bool = True, **more) -> Part:
    return part_of(PartRecord(name, "mm", 1e-3, oriented, faces, **more))


@pytest.fixture(scope="session")
def made() -> SimpleNamespace:
    """What makes parts; tests import nothing from each other."""
    functions = (
        placement,
        rectangle,
        face,
        box_faces,
        cylinder_faces,
        part,
        side,
        edge,
        cylinder,
        ball,
    )
    return SimpleNamespace(TURN=TURN, **{x.__name__: x for x in functions})
