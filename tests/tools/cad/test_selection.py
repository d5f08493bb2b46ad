"""Some faces of a part, and what they are called by."""

import json
import pickle

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.edges import between_two
from gaussmap.tools.cad.examples import all_kinds, box
from gaussmap.tools.cad.records import FaceRecord, Geometry

from ...products import covering
from ...refusals import refused

TURN = 2.0 * np.pi


def indices(part) -> list[int]:
    return [x.source_index for x in part.faces]


def test_conditions(made):
    failed = FaceRecord(Geometry("unknown"), reason="it has no surface", area=np.nan)
    part = made.part([*made.cylinder_faces(), failed])
    assert indices(part.select(kind="plane")) == [1, 2]
    assert indices(part.select(kind=("unknown", "cylinder"))) == [0, 3]
    assert indices(part.select(color="#ff8000")) == [0]  # 0x80 is 128, and 0.5 is 127.5
    assert indices(part.select(color=(1.0, 0.5, 0.0))) == [0]
    assert indices(part.select(index=[3, 1])) == [1, 3]
    assert indices(part.select(kind="plane", normal=((0, 0, -3), 1.0))) == [1]
    message = r"conditions; the kinds of its faces are: 2 plane, 1 cylinder, 1 unknown\.$"
    with pytest.raises(gm.errors.InputError, match=message):
        part.select(kind="plane", color="#ff8000")


def test_names():
    part = all_kinds()
    part.about["face_names"] = {"2": "slot 1", "7": "slot 2", "8": "Slot 3"}
    assert indices(part.select(name="slot*")) == [2, 7]
    assert indices(part.select(name="slot 2")) == [7]


def test_a_selection_of_a_selection_knows_the_first_part():
    part = box().select(index=[1, 3, 5]).select(index=[0, 2])
    assert indices(part) == [1, 5]
    assert indices(pickle.loads(pickle.dumps(part))) == [1, 5]
    assert [x.index for x in part.faces] == [0, 1]


def test_all_normals_of_a_face_have_to_be_within_the_angle(made):
    quarter = made.face(
        "cylinder", [*made.placement(), 1.0], (0.0, TURN / 4), (0.0, 2.0), TURN / 2, (TURN, 0.0)
    )
    part = made.part([quarter], oriented=False)
    toward = (np.cos(TURN / 8), np.sin(TURN / 8), 0.0)
    assert len(part.select(normal=(toward, 45.001))) == 1
    for axis, angle in ((toward, 44.9), ((1, 0, 0), 89.0), ((-1, -1, 0), 170.0)):
        refused("no face", part.select, normal=(axis, angle))


def test_the_trim_counts_and_poles_do_not_hurt(made):
    # A cap of 30° around the north pole of a sphere, as a circle of parameters would be cut.
    place, u, v = [*made.placement(), 2.0], (0.0, TURN), (TURN / 6, TURN / 4)
    cap = made.face("sphere", place, u, v, 1.0, (TURN, 0.0))
    assert len(made.part([cap]).select(normal=((0, 0, 1), 30.001))) == 1
    refused("no face", made.part([cap]).select, normal=((0, 0, 1), 29.9))
    narrow = made.face(
        "sphere", place, (0.0, TURN), (-TURN / 4, TURN / 4), 1.0, (TURN, 0.0),
        loops=[np.array([(1.0, -0.1), (1.2, -0.1), (1.2, 0.1), (1.0, 0.1)])],
    )  # fmt: skip
    middle = (np.cos(1.1), np.sin(1.1), 0.0)
    assert len(made.part([narrow]).select(normal=(middle, 9.0))) == 1


def test_samples_and_edges_of_a_selection():
    part = box(1.0, 2.0, 3.0).select(index=[0, 2, 5])
    assert (part.unit, part.solids[0].name, part.area) == ("mm", "box", 6 + 3 + 2)
    assert between_two(part)[0].tolist() == [[0, 1], [0, 2], [1, 2]]
    assert len(part.arrays["edge_vertices"]) == 9  # six borders, too
    on_faces = part.arrays["side_faces"][part.arrays["wire_sides"]]
    assert on_faces.tolist() == [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]
    samples = gm.sample(part, 60, edges=True)
    assert samples.report is not None
    assert samples.report.edge_samples
    whole = box(1.0, 2.0, 3.0)
    for face in part.faces:
        own = samples.points[samples.face_index == face.index]
        dimensions = whole.faces[face.source_index].dimensions
        assert np.abs((own - dimensions["point"]) @ dimensions["normal"]).max() <= 1e-15


def test_solids_are_numbered_anew(made):
    faces = [made.cylinder_faces(), made.cylinder_faces(2.0)]
    records = [x for k in (0, 1) for x in faces[k]]
    for k, record in enumerate(records):
        object.__setattr__(record, "solid_index", k // 3)
    part = made.part(records, solid_names=["a", "b"]).select(index=[4, 5])
    assert [x.name for x in part.solids] == ["b"]
    assert part.solids[0].faces.tolist() == [0, 1]


def test_open_ends_of_solids_have_no_volume(made):
    part = made.part(made.cylinder_faces())
    assert part.volume == pytest.approx(TURN, rel=1e-4)
    with pytest.raises(gm.errors.SurfaceError, match="enclose no solids"):
        _ = part.select(kind="plane").volume


def test_a_selection_is_saved(tmp_path):
    path = tmp_path / "part.npz"
    box().select(index=[1, 4]).save(path)
    assert indices(gm.read_part(path)) == [1, 4]


@pytest.mark.parametrize("bad", ["no list", ["a", "b"], [1], [1.5, 2], {"1": 2}])
def test_source_indices_of_files_are_checked(tmp_path, bad):
    part = box().select(index=[1, 4])
    about = part.about | {"source_indices": bad}
    part.arrays["about"] = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    part.save(tmp_path / "part.npz")
    with pytest.raises(gm.errors.FileError, match="'about' is not what it should be"):
        gm.read_part(tmp_path / "part.npz")


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
        ({"index": [0.5]}, "index must be whole numbers, places"),
        ({"index": [0, [1, 2]]}, "index must be an array of real numbers, with equal rows"),
        ({"normal": (0, 0, 1)}, "normal must be"),
        ({"normal": ((0, 0, 0), 1)}, "the direction of normal is the zero vector"),
        ({"normal": ((0, 0, 1), 0)}, "the angle of normal"),
    ],
)
def test_errors(condition, message):
    with pytest.raises((gm.errors.InputError, gm.errors.UnknownNameError), match=message):
        box().select(**condition)


# --- dimensions -----------------------------------------------------------------------------------


@covering(
    handed=[1.0, -1.0],
    is_reversed=[False, True],
    **{
        "kind, more, u, v": [
            ("plane", [], (0.0, 1.0), (0.0, 1.0)),
            ("cylinder", [2.0], (0.5, 3.0), (-1.0, 1.0)),
            ("cone", [2.0, 0.3], (0.5, 3.0), (0.0, 1.0)),
            ("cone", [2.0, -0.3], (0.5, 3.0), (0.0, 1.0)),
            ("cone", [2.0, 0.3], (0.5, 3.0), (-9.0, -8.0)),  # beyond the apex
            ("sphere", [3.0], (0.5, 3.0), (-0.5, 1.0)),
            ("torus", [3.0, 0.5], (0.5, 3.0), (0.5, 6.0)),
        ]
    },
)
def test_dimensions_are_those_of_points_and_normals(made, kind, more, u, v, is_reversed, handed):
    axes = np.array([[2, 1, -2], [1, 2, 2], [2, -2, 1]]) / 3
    numbers = [5.0, -2.0, 1.0, *axes[0], *(handed * axes[1]), *axes[2], *more]
    part = made.part([made.face(kind, numbers, u, v, 1.0, reversed=is_reversed)], oriented=False)
    (face,) = part.faces
    samples, known = gm.sample(part, 50), face.dimensions
    points, normals = samples.points, samples.normals
    if kind == "plane":
        assert np.allclose(normals, known["normal"], atol=1e-14)
        assert np.allclose((points - known["point"]) @ known["normal"], 0.0, atol=1e-14)
        return
    centre = known.get("point", known.get("apex", known.get("centre")))
    across = points - centre
    height = across @ known.get("axis", np.zeros(3))
    radial = across - height[:, None] * known.get("axis", np.zeros(3))
    distance = np.linalg.norm(radial, axis=1)
    if kind == "cone":
        assert np.allclose(distance, height * np.tan(np.radians(known["half_angle"])), atol=1e-13)
        assert (height > 0.0).all()
    elif kind == "torus":
        radial *= (1.0 - known["major_radius"] / distance)[:, None]
        radial += height[:, None] * known["axis"]
        assert np.allclose(np.linalg.norm(radial, axis=1), known["minor_radius"], atol=1e-14)
    else:
        assert np.allclose(distance, known["radius"], atol=1e-14)
    inward = np.einsum("ij,ij->i", radial, normals) < 0.0
    assert inward.all() if known["hollow"] else not inward.any()


def test_other_kinds_have_none(made):
    assert all_kinds().faces[5].dimensions == {}
    flat = [*made.placement(), 2.0, 0.0]  # a cone that does not widen
    assert made.part([made.face("cone", flat, (0, 1), (0, 1), 1.0)]).faces[0].dimensions == {}


# --- the command ----------------------------------------------------------------------------------


def test_faces_of_a_kind(made, tmp_path, capsys, main):
    path = str(tmp_path / "part.npz")
    failed = FaceRecord(Geometry("unknown"), reason="it has no surface", area=np.nan)
    made.part([*made.cylinder_faces(), failed]).save(path)
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
    assert main(["faces", path, "--name", "slot*"]) == 2
    assert main(["faces", path, "--kind", "hole"]) == 2
