"""Some faces of a part, and what they are called by."""

import json
import pickle
from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.edges import between_two
from gaussmap.tools.cad.examples import all_kinds, box

from ...products import covering
from ...refusals import refused
from .made import (
    AXES,
    FAILED,
    TURN,
    UNIT,
    cylinder_faces,
    face,
    has_its_dimensions,
    part,
    rectangle,
)


def indices(part) -> list[int]:
    return [x.source_index for x in part.faces]


@pytest.fixture(scope="module")
def failing() -> gm.Part:
    """Return a cylinder with a face that failed."""
    return part([*cylinder_faces(), replace(FAILED, area=np.nan)])


@pytest.mark.parametrize(
    ("conditions", "found"),
    [
        ({"kind": "plane"}, [1, 2]),
        ({"kind": ("unknown", "cylinder")}, [0, 3]),
        ({"color": "#ff8000"}, [0]),  # 0x80 is 128, and 0.5 is 127.5
        ({"color": (1.0, 0.5, 0.0)}, [0]),
        ({"index": [3, 1]}, [1, 3]),
        ({"kind": "plane", "normal": ((0, 0, -3), 1.0)}, [1]),
    ],
)
def test_conditions(failing, conditions, found):
    assert indices(failing.select(**conditions)) == found


def test_names():
    kinds = all_kinds()
    kinds.about["face_names"] = {"2": "slot 1", "7": "slot 2", "8": "Slot 3"}
    assert indices(kinds.select(name="slot*")) == [2, 7]
    assert indices(kinds.select(name="slot 2")) == [7]


def test_a_selection_of_a_selection_knows_the_first_part():
    some = box().select(index=[1, 3, 5]).select(index=[0, 2])
    assert indices(some) == [1, 5]
    assert indices(pickle.loads(pickle.dumps(some))) == [1, 5]
    assert [x.index for x in some.faces] == [0, 1]


QUARTER = face("cylinder", 1.0, u=(0.0, TURN / 4), v=(0.0, 2.0))
# A cap of 30° around the north pole of a sphere, as a circle of parameters would be cut.
CAP = face("sphere", 2.0, v=(TURN / 6, TURN / 4))
NARROW = face("sphere", 2.0, area=1.0, loops=[rectangle((1.0, 1.2), (-0.1, 0.1))])


def toward(angle: float) -> tuple[float, float, float]:
    return np.cos(angle), np.sin(angle), 0.0


@pytest.mark.parametrize(
    ("given", "normal", "is_found"),
    [
        (QUARTER, (toward(TURN / 8), 45.001), True),
        (QUARTER, (toward(TURN / 8), 44.9), False),
        (QUARTER, ((1, 0, 0), 89.0), False),
        (QUARTER, ((-1, -1, 0), 170.0), False),
        (CAP, ((0, 0, 1), 30.001), True),
        (CAP, ((0, 0, 1), 29.9), False),
        (NARROW, (toward(1.1), 9.0), True),
    ],
)
def test_all_normals_inside_of_the_trim_have_to_be_within_the_angle(given, normal, is_found):
    """Poles do not hurt."""
    alone = part([given], oriented=False)
    if is_found:
        assert len(alone.select(normal=normal)) == 1
    else:
        refused("no face", alone.select, normal=normal)


def test_samples_and_edges_of_a_selection():
    some = box().select(index=[0, 2, 5])
    assert (some.unit, some.solids[0].name, some.area) == ("mm", "box", 6 + 3 + 2)
    assert between_two(some)[0].tolist() == [[0, 1], [0, 2], [1, 2]]
    assert len(some.arrays["edge_vertices"]) == 9  # six borders, too
    on_faces = some.arrays["side_faces"][some.arrays["wire_sides"]]
    assert on_faces.tolist() == [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]
    samples = gm.sample(some, 60, edges=True)
    assert (samples.report.edge_samples or 0) > 0
    for own_face in some.faces:
        own = samples.points[samples.face_index == own_face.index]
        dimensions = box().faces[own_face.source_index].dimensions
        assert np.abs((own - dimensions["point"]) @ dimensions["normal"]).max() <= 1e-15


def test_solids_are_numbered_anew():
    two = cylinder_faces() + [replace(x, solid_index=1) for x in cylinder_faces(2.0)]
    some = part(two, solid_names=["a", "b"]).select(index=[4, 5])
    assert [x.name for x in some.solids] == ["b"]
    assert some.solids[0].faces.tolist() == [0, 1]


def test_open_ends_of_solids_have_no_volume():
    whole = part(cylinder_faces())
    assert whole.volume == pytest.approx(TURN, rel=1e-4)
    error = gm.errors.SurfaceError
    refused("enclose no solids", lambda: whole.select(kind="plane").volume, error=error)


@pytest.mark.parametrize("bad", ["no list", ["a", "b"], [1], [1.5, 2], {"1": 2}])
def test_source_indices_of_files_are_checked(tmp_path, bad):
    some = box().select(index=[1, 4])
    about = some.about | {"source_indices": bad}
    some.arrays["about"] = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    some.save(tmp_path / "part.npz")
    wrong, error = "'about' is not what it should be", gm.errors.FileError
    refused(wrong, gm.read_part, tmp_path / "part.npz", error=error)


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ({"kind": "hole"}, "'hole'"),
        ({"kind": 3}, "kind must be a name or a list"),
        ({"name": 3}, "name must be"),
        ({"color": "red"}, "color must be a text such as"),
        ({"color": (1, 2)}, "color must"),
        ({"index": [6]}, "index holds 6, and the faces are 0 to 5"),
        ({"index": [-1]}, "index holds -1"),
        ({"index": [0.5]}, "index must be whole numbers, indices"),
        ({"index": [0, [1, 2]]}, "index must be an array of real numbers, with equal rows"),
        ({"normal": (0, 0, 1)}, "normal must be"),
        ({"normal": ((0, 0, 0), 1)}, "the direction of normal is the zero vector"),
        ({"normal": ((0, 0, 1), 0)}, "the angle of normal"),
    ],
)
def test_errors(condition, message):
    error = gm.errors.UnknownNameError if condition == {"kind": "hole"} else gm.errors.InputError
    refused(message, box().select, **condition, error=error)


def test_where_no_face_is_found_the_kinds_are_listed(failing):
    message = r"conditions; the kinds of its faces are: 2 plane, 1 cylinder, 1 unknown\.$"
    refused(message, failing.select, kind="plane", color="#ff8000")


# --- dimensions -----------------------------------------------------------------------------------


@covering(
    handed=[1.0, -1.0],
    is_reversed=[False, True],
    **{
        "kind, more, u, v": [
            ("plane", [], UNIT, UNIT),
            ("cylinder", [2.0], (0.5, 3.0), (-1.0, 1.0)),
            ("cone", [2.0, 0.3], (0.5, 3.0), UNIT),
            ("cone", [2.0, -0.3], (0.5, 3.0), UNIT),
            ("cone", [2.0, 0.3], (0.5, 3.0), (-9.0, -8.0)),  # beyond the apex
            ("sphere", [3.0], (0.5, 3.0), (-0.5, 1.0)),
            ("torus", [3.0, 0.5], (0.5, 3.0), (0.5, 6.0)),
        ]
    },
)
def test_dimensions_are_those_of_points_and_normals(kind, more, u, v, is_reversed, handed):
    place = [5.0, -2.0, 1.0, *AXES[0], *(handed * AXES[1]), *AXES[2]]
    alone = part([face(kind, *more, u=u, v=v, place=place, reversed=is_reversed)], oriented=False)
    has_its_dimensions(alone)


def test_other_kinds_have_none():
    assert all_kinds().faces[5].dimensions == {}
    assert part([face("cone", 2.0, 0.0)]).faces[0].dimensions == {}  # it does not widen


# --- the command ----------------------------------------------------------------------------------


def test_faces_of_a_kind(failing, tmp_path, capsys, main):
    path = str(tmp_path / "part.npz")
    failing.save(path)
    assert main(["faces", path]) == 0
    assert [x.split() for x in capsys.readouterr().out.splitlines()] == [
        ["0", "cylinder", "12.5664", "1", "loop"],
        ["1", "plane", "3.14159", "1", "loop"],
        ["2", "plane", "3.14159", "1", "loop"],
        ["3", "unknown", "nan", "0", "loops", "failed:", "it", "has", "no", "surface"],
    ]
    assert main(["faces", path, "--kind", "plane", "--kind", "unknown"]) == 0
    assert [x.split()[0] for x in capsys.readouterr().out.splitlines()] == ["1", "2", "3"]
    assert main(["faces", path, "--kind", "cylinder", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "part": "part",
        "unit": "mm",
        "metres": 0.001,
        "faces": [
            {
                "index": 0, "kind": "cylinder", "name": "", "color": [1.0, 0.5, 0.0],
                "area": pytest.approx(2 * TURN), "solid": "", "reason": "", "point": [0, 0, 0],
                "axis": [0, 0, 1], "radius": 1.0, "hollow": False,
            }
        ],
    }  # fmt: skip
    assert main(["faces", path, "--kind", "unknown", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["faces"][0]["area"] is None
