"""Tables of samples say on which face of the file each one lies."""

import csv

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.files import tables

NAMES = ["source_index", "face_name", "face_kind", "face_radius [mm]"]
STRANGE = 'slot "A", Ø 5\nupper'


@pytest.fixture(scope="module")
def samples(parts) -> gm.Samples:
    part = parts.all_kinds()
    part.about["face_names"] = {"1": STRANGE}
    return gm.sample(part.select(kind=("cylinder", "sphere", "torus", "cone")), 60)


def rows_of(path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def radius_of(face) -> str:
    found = face.dimensions
    size = found["minor_radius"] if face.kind == "torus" else found.get("radius", "")
    return repr(size) if size else ""


@pytest.mark.parametrize("least", [0, 1000])
def test_rows_name_the_face_of_the_file(samples, tmp_path, monkeypatch, least):
    monkeypatch.setattr(tables, "WORTH_AN_IMPORT", least)
    samples.write(tmp_path / "a.csv")
    rows = rows_of(tmp_path / "a.csv")
    assert list(rows[0])[-4:] == NAMES
    faces = [samples.surface.faces[k] for k in samples.face_index]
    wanted = [[str(x.source_index), x.name, x.kind, radius_of(x)] for x in faces]
    assert [[row[name] for name in NAMES] for row in rows] == wanted
    kinds = {x[2] for x in wanted}
    assert kinds == {"cylinder", "sphere", "torus", "cone"}
    assert [*map(float, (row["x [mm]"] for row in rows))] == samples.points[:, 0].tolist()


def test_moved_samples_keep_part_and_unit(samples, tmp_path):
    samples.offset(0.1).write(tmp_path / "a.csv")
    samples.write(tmp_path / "b.csv")
    moved, still = rows_of(tmp_path / "a.csv"), rows_of(tmp_path / "b.csv")
    assert [[x[y] for y in NAMES] for x in moved] == [[x[y] for y in NAMES] for x in still]
    assert moved[0]["x [mm]"] != still[0]["x [mm]"]


def test_without_faces_there_are_no_such_columns(samples, tmp_path):
    samples.write(tmp_path / "a.csv", fields=("points", "normals"))
    assert list(rows_of(tmp_path / "a.csv")[0]) == ["x [mm]", "y [mm]", "z [mm]", "nx", "ny", "nz"]


def test_arrow_and_pandas_have_them(samples, tmp_path):
    pandas, parquet = pytest.importorskip("pandas"), pytest.importorskip("pyarrow.parquet")
    samples.write(tmp_path / "a.parquet")
    table, frame = parquet.read_table(tmp_path / "a.parquet"), samples.to_dataframe()
    faces = [samples.surface.faces[k] for k in samples.face_index]
    assert table["face_name"].to_pylist() == [x.name for x in faces]
    assert STRANGE in table["face_name"].to_pylist()
    assert table["source_index"].to_pylist() == [x.source_index for x in faces]
    radii = [radius_of(x) for x in faces]
    assert table["face_radius"].to_pylist() == [float(x) if x else None for x in radii]
    assert table.schema.field("face_radius").metadata == {b"unit": b"mm"}
    pandas.testing.assert_frame_equal(pandas.read_parquet(tmp_path / "a.parquet"), frame)
    np.testing.assert_array_equal(np.isnan(frame["face_radius"]), [not x for x in radii])


def test_the_command_writes_probe_points(tmp_path, main, parts):
    parts.all_kinds().save(tmp_path / "a.npz")
    path = tmp_path / "probe.csv"
    line = ["sample", str(tmp_path / "a.npz"), "--count", "40", "--reach", "0", "0", "1", "60"]
    assert main([*line, "--fields", "points,normals,face_index", "-o", str(path)]) == 0
    rows = rows_of(path)
    assert len(rows) == 40
    assert list(rows[0]) == ["x [mm]", "y [mm]", "z [mm]", "nx", "ny", "nz", "face_index", *NAMES]
    assert min(float(x["nz"]) for x in rows) >= 0.5 - 1e-12
