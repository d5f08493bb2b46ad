"""Parts in files: the same again, and one sentence for anything else."""

# pyright: reportArgumentType=false

import csv
import json
import pickle
from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import box_faces
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import EdgeRecord, FaceRecord, Geometry, Net
from gaussmap.tools.cad.saving import write_arrays

from ...refusals import refused
from .made import FAILED, UNIT, cylinder_faces, net, part, rectangle

CURVE = net([[1.0, 0, 0], [1, 0, 2]], knots=[0.0, 0.0, 1.0, 1.0])


def of_random(m: int, n: int, rational: bool) -> Net:
    rng = np.random.default_rng(0)
    knots = tuple(np.r_[[0.0] * 3, np.linspace(0, 1, k - 1)[1:-1], [1.0] * 3] for k in (m, n))
    weights = rng.uniform(1, 2, (m, n)) if rational else None
    return Net((2, 2), knots, rng.normal(size=(m, n, 3)), weights)


@pytest.fixture
def everything() -> Part:
    """Return a part with each kind of record."""
    square = [rectangle(UNIT, UNIT), rectangle((0.2, 0.4), (0.2, 0.4))]
    basis = Geometry("nurbs", net=of_random(4, 5, True))
    geometries = [
        Geometry("nurbs", net=of_random(3, 4, False)),
        Geometry("offset", np.array([0.5]), basis=Geometry("offset", np.array([0.1]), basis=basis)),
        Geometry("revolution", np.array([0.0, 0, 0, 0, 0, 1]), net=CURVE),
        Geometry("extrusion", np.array([0.0, 1, 0]), net=CURVE),
    ]
    faces = [FaceRecord(x, ((0, 1), (0, 1)), loops=square, area=1.0) for x in geometries]
    edges = [
        EdgeRecord((0, 2), np.arange(12.0).reshape(3, 4), vertices=(1, 0)),
        EdgeRecord((0, 0), np.zeros((2, 4)), np.ones((2, 4)), degenerate=True),
    ]
    first, *others = box_faces()
    first = replace(first, wires=[[(0, 0, True), (1, 1, False)], [(1, 0, True)]])
    given = {"solid_names": ["bolt"], "edges": edges, "vertices": np.eye(3)[:2]}
    return part([first, *others, *faces, FAILED], "all", False, **given)


def again(given: Part, path) -> Part:
    given.save(path / "part.npz")
    return gm.read_part(path / "part.npz")


def is_refused(match: str, path) -> None:
    refused(match, gm.read_part, path, error=gm.errors.FileError)


def same(one: Part, other: Part) -> bool:
    return one.about == other.about and all(
        np.array_equal(x, other.arrays[name], equal_nan=x.dtype.kind == "f")
        for name, x in one.arrays.items()
    )


def test_read_again(everything, tmp_path):
    assert same(everything, again(everything, tmp_path))
    assert same(everything, pickle.loads(pickle.dumps(everything)))


def test_wires_of_faces(everything):
    assert everything.faces[0].wires == (((0, True), (3, False)), ((2, True),))
    assert everything.faces[1].wires == ()
    np.testing.assert_allclose(everything.arrays["side_points"][:3, 2:], 8.0)  # by differences


def test_geometries_are_unpacked(everything):
    faces = everything.faces[6:]
    assert [x.kind for x in faces] == ["nurbs", "offset", "revolution", "extrusion", "unknown"]
    inner = faces[1].geometry.basis
    assert inner.numbers.tolist() == [0.1]
    assert np.array_equal(inner.basis.net.weights, of_random(4, 5, True).weights)
    assert [x.shape for x in faces[0].loops] == [(4, 2), (4, 2)]
    assert faces[4].loops == ()


def test_what_a_part_says(everything):
    said = len(everything), everything.unit, everything.metres, everything.oriented
    assert said == (11, "mm", 1e-3, False)
    assert everything.area == pytest.approx(22 + 4)
    assert [x.index for x in everything.failed] == [10]
    unusable, error = "face 10 of 'all' cannot be used: it has no", gm.errors.SurfaceError
    refused(unusable, lambda: everything.failed[0].surface, error=error)
    (solid,) = everything.solids
    assert (solid.name, solid.faces.tolist(), solid.area) == ("bolt", list(range(6)), 22.0)
    first = everything.faces[0]
    assert (first.name, first.color, first.solid_index, first.reversed) == ("side", None, 0, True)
    assert part(cylinder_faces()).faces[0].color == (1.0, 0.5, 0.0)


def test_no_faces(tmp_path):
    empty = again(part([], "empty"), tmp_path)
    assert (len(empty), empty.faces, empty.solids, empty.area) == (0, (), (), 0.0)


NOT_FINITE = "its numbers are not finite"


@pytest.mark.parametrize(
    ("name", "place", "number", "face", "reason"),
    [
        ("area", 0, 1e308, 0, "its area is out of range"),
        ("area", 0, 1e-320, 0, "its area is out of range"),
        ("loop_points", 0, 1e9, 0, "its boundary is outside of its domain"),
        ("numbers", 0, np.nan, 0, NOT_FINITE),
        ("net_points", (0, 0), np.nan, 6, NOT_FINITE),
        ("net_points", (-1, 3), np.inf, 7, NOT_FINITE),  # of the basis of the basis
    ],
)
def test_numbers_that_cannot_be_fail_one_face(
    name, place, number, face, reason, everything, tmp_path
):
    everything.arrays[name][place] = number
    failed = again(everything, tmp_path).failed
    assert [x.index for x in failed] == [face, 10]
    assert failed[0].reason == reason
    assert failed[0].part.area < 27.0


@pytest.mark.parametrize(
    "entry",
    [
        {"reasons": ["a"]}, {"reasons": {"0": 3}}, {"reasons": {"11": "late"}},
        {"reasons": {"-1": "early"}}, {"face_names": None}, {"face_names": {"0": None}},
        {"face_names": {"x": "no index"}}, {"warnings": "one"}, {"warnings": [1]},
        {"solid_names": {"0": "bolt"}}, {"name": 3}, {"unit": None}, {"metres": "long"},
        {"metres": 0.0}, {"metres": True}, {"metres": float("nan")}, {"oriented": 1},
        {"source_indices": [0]}, {"source_indices": [True] * 11}, {"source_indices": None},
    ],
)  # fmt: skip
def test_entries_are_what_is_written(entry, everything, tmp_path):
    text = json.dumps(everything.about | entry).encode()
    damaged = everything.arrays | {"about": np.frombuffer(text, dtype=np.uint8)}
    write_arrays(damaged, tmp_path / "part.npz")
    is_refused("is damaged: its array 'about'", tmp_path / "part.npz")


DAMAGE = [
    ("number_starts", lambda x: x[::-1].copy()),
    ("kind", lambda x: x + 50),
    ("basis", lambda x: np.where(x < 0, x, 0)),
    ("net", lambda x: np.where(x < 0, x, 10**6)),
    ("net_shapes", lambda x: x + 1),
    ("knots", lambda x: x[1:]),
    ("side_faces", lambda x: x + 10**6),
    ("side_point_starts", lambda x: np.r_[x[:1], x[1:-1] + 1, x[-1:]]),
    ("edge_vertices", lambda x: x + 10**6),
    ("wire_sides", lambda x: x + 1),
    ("solid_index", lambda x: x + 10**6),
    ("area", lambda x: x[1:]),
    ("domain", lambda x: x.reshape(-1, 4)),
    ("reversed", lambda x: x.astype(object)),
    ("about", lambda x: x[1:]),
    ("about", lambda x: np.frombuffer(b'{"format": "no"}', dtype=np.uint8)),
]


@pytest.mark.parametrize(("name", "change"), DAMAGE)
def test_damaged_arrays(everything, tmp_path, name, change):
    write_arrays(
        {**everything.arrays, name: change(everything.arrays[name])}, tmp_path / "part.npz"
    )
    is_refused(r"part\.npz' (is damaged|is no part|comes from)", tmp_path / "part.npz")


def test_truncated_foreign_and_missing_files(everything, tmp_path):
    everything.save(tmp_path / "part.npz")
    whole = (tmp_path / "part.npz").read_bytes()
    for length in (0, 3, 1000, len(whole) // 2, len(whole) - 1):
        (tmp_path / "cut.npz").write_bytes(whole[:length])
        is_refused(r"cut\.npz' is damaged", tmp_path / "cut.npz")
    np.savez(tmp_path / "other.npz", a=np.arange(3))
    is_refused("is no part that gaussmap saved: it lacks", tmp_path / "other.npz")
    is_refused("cannot be read", tmp_path / "none.npz")
    refused("", gm.read_part, tmp_path / "part.step", error=gm.errors.UnknownNameError)


# --- parts on the command line --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("part.step", "ISO-10303-21;"),
        ("part.RLE", ""),
        ("part.txt", "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n"),
        ("part", "ISO-10303-21;"),
    ],
)
def test_without_open_cascade(tmp_path, capsys, monkeypatch, main, name, content):
    """Files of all suffixes are known; without the extra, the error says how to install it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(content)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["sample", name, "--count", "10", "-o", "out.ply"]) == 2
    assert 'pip install "gaussmap[cad]"' in capsys.readouterr().err


FORMULAS = '=HYPERLINK("x")', "+1", "-1", "@SUM(1)", "\t=1"


def test_names_are_no_formulas_of_spreadsheets(tmp_path, capsys, main, monkeypatch):
    """Names of faces come from files of others; escapes on a terminal, too."""
    monkeypatch.chdir(tmp_path)
    names = dict(zip(range(6), ["\x1b[2Jslot\n", *FORMULAS], strict=True))
    records = [replace(x, name=names[k]) for k, x in enumerate(box_faces())]
    whole = part(records)
    gm.sample(whole, 60).write("names.csv")
    with open("names.csv", newline="") as file:
        found = {row["face_name"] for row in csv.DictReader(file)}
    assert found == {names[0], *(f"'{x}" for x in FORMULAS)}
    whole.save("names.npz")
    assert main(["faces", "names.npz"]) == 0
    out = capsys.readouterr().out
    assert len(out.splitlines()) == 6
    assert r"\x1b[2Jslot" in out
    assert "\x1b" not in out
