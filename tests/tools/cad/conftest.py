"""Parts made of numbers, for tests without Open CASCADE."""

from types import SimpleNamespace

import numpy as np
import pytest
from gaussmap.tools.cad.examples import box_faces
from gaussmap.tools.cad.part import Part, part_of
from gaussmap.tools.cad.records import FaceRecord, Geometry, PartRecord

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


def part(faces, name: str = "part", oriented: bool = True, **more) -> Part:
    return part_of(PartRecord(name, "mm", 1e-3, oriented, faces, **more))


@pytest.fixture(scope="session")
def made() -> SimpleNamespace:
    """What makes parts; tests import nothing from each other."""
    functions = placement, rectangle, face, box_faces, cylinder_faces, part
    return SimpleNamespace(TURN=TURN, **{x.__name__: x for x in functions})
