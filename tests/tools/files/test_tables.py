"""Tables in files, by pyarrow, pandas and Polars: numbers, faces of parts and units."""

import csv
import io
import json
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.files import tables
from gaussmap.tools.files.lengths import METRES, unit_named

from .made import columns_of, make


def noise(count: int, dtype: Any = np.float64) -> gm.Samples:
    """Samples with truth values and the longest indices, too."""
    index = np.linspace(-1, 2.0**62, count).astype(np.int64)
    return make(count, dtype=dtype, normal_index=index, on_surface=np.arange(count) % 3 > 0)


def assert_equal(column: Any, wanted: np.ndarray) -> None:
    found = np.asarray(column)
    assert found.dtype == wanted.dtype
    assert np.ascontiguousarray(found).tobytes() == np.ascontiguousarray(wanted).tobytes()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_parquet_keeps_every_bit_types_units_and_the_report(tmp_path, dtype):
    parquet = pytest.importorskip("pyarrow.parquet")
    samples, path = noise(5000, dtype), tmp_path / "a.parquet"
    samples.write(path)
    read = parquet.read_table(path)
    columns = columns_of(samples)
    assert read.column_names == list(columns)
    for name, column in columns.items():
        assert_equal(read[name].to_numpy(), column)
    about = read.schema.metadata
    assert about[b"gaussmap"] == gm.__version__.encode()
    assert SamplingReport(**json.loads(about[b"report"])) == samples.report
    assert read.schema.field("y").metadata[b"unit"] == b"L"
    assert read.schema.field("gaussian_curvature").metadata[b"unit"] == b"1/L^2"
    assert read.schema.field("v").metadata[b"field"] == b"uv"


def written(samples: gm.Samples, monkeypatch: pytest.MonkeyPatch, least: int) -> list[str]:
    """Return the lines of a .csv file; Polars writes `least` samples and more."""
    monkeypatch.setattr(tables, "WORTH_AN_IMPORT", least)
    columns, file = columns_of(samples), io.BytesIO()
    tables.write_rows(file, ",".join(["{}"] * len(columns)) + "\n", list(columns.values()))
    return file.getvalue().decode("ascii").splitlines()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_polars_writes_the_same_numbers(monkeypatch, dtype):
    monkeypatch.setattr(tables, "ROWS_OF_POLARS", 400)
    samples = noise(1000, dtype)
    texts = written(samples, monkeypatch, 0), written(samples, monkeypatch, 1001)
    assert texts[0] != texts[1]  # Polars writes exponents in another way
    for text in texts:
        rows = [line.split(",") for line in text]
        for k, column in enumerate(columns_of(samples).values()):
            kind = int if column.dtype.kind in "ib" else float
            numbers = np.array([kind(row[k]) for row in rows])
            assert_equal(numbers.astype(column.dtype), column)


def test_text_without_polars(monkeypatch):
    samples = noise(20)
    monkeypatch.setattr(tables, "if_installed", lambda _: None)
    assert len(written(samples, monkeypatch, 0)) == 20


@pytest.mark.parametrize("least", [0, 9])
def test_numbers_have_no_digits_more_than_it_takes(monkeypatch, least):
    monkeypatch.setattr(tables, "WORTH_AN_IMPORT", least)
    file, numbers = io.BytesIO(), np.array([10.2, 0.1, 1.0 / 3.0, -250.0])
    tables.write_rows(file, "{},{}\n", [numbers, np.arange(4)])
    assert file.getvalue() == b"10.2,0\n0.1,1\n0.3333333333333333,2\n-250.0,3\n"
    file, index = io.BytesIO(), np.arange(2)
    tables.write_rows(file, "f {}/{}/{} {}\n", [index, index + 1, index + 2, 1.5 * index])
    assert file.getvalue() == b"f 0/1/2 0.0\nf 1/2/3 1.5\n"


# --- faces of parts in tables ---------------------------------------------------------------------

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


# --- units of length ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "unit"),
    [("MM", "mm"), (" millimetre", "mm"), ("INCH", "in"), ("Foot", "ft"),
     ("US survey foot", "us-ft"), ("ell", None)],
)  # fmt: skip
def test_units_have_several_names(name, unit):
    assert unit_named(name) == unit


def test_lengths_are_those_of_the_standards():
    assert METRES["in"] == 0.0254
    assert METRES["ft"] == pytest.approx(12 * METRES["in"])
    assert METRES["yd"] == pytest.approx(3 * METRES["ft"])
    assert METRES["mi"] == pytest.approx(5280 * METRES["ft"])
    assert METRES["mil"] == pytest.approx(METRES["in"] / 1_000)
    assert METRES["uin"] == pytest.approx(METRES["in"] / 1_000_000)
    assert METRES["us-ft"] * 3937 == pytest.approx(1200, rel=1e-15)
    assert METRES["ft"] / METRES["us-ft"] == pytest.approx(1 - 2e-6, rel=1e-12)
    metric = [METRES[x] for x in ("nm", "um", "mm", "cm", "dm", "m", "km")]
    assert metric == [1e-9, 1e-6, 1e-3, 1e-2, 1e-1, 1.0, 1e3]


def header(samples, folder):
    samples.write(folder / "a.csv")
    return (folder / "a.csv").read_text().partition("\n")[0].split(",")


def terrain(crs):
    x = np.arange(12.0)
    return gm.terrain(np.sin(x)[:, None] * np.cos(x), spacing=(1.0, 1.0), crs=crs)


def test_tables_of_parts_name_the_unit(tmp_path):
    part = gm.read_part(f"{gm.__path__[0]}/docs/gallery/bracket.npz")
    samples = gm.sample(part, 40)
    names = header(samples, tmp_path)
    assert names[:4] == ["x [mm]", "y [mm]", "z [mm]", "nx"]
    assert {"support [mm]", "gaussian_curvature [1/mm^2]", "mean_curvature [1/mm]"} <= {*names}
    parquet = pytest.importorskip("pyarrow.parquet")
    samples.write(tmp_path / "a.parquet")
    schema = parquet.read_schema(tmp_path / "a.parquet")
    assert schema.metadata[b"unit_of_length"] == b"mm"
    assert schema.field("x").metadata[b"unit"] == b"mm"
    assert schema.field("gaussian_curvature").metadata[b"unit"] == b"1/mm^2"
    assert schema.field("nx").metadata[b"unit"] == b"1"


@pytest.mark.parametrize(("crs", "name"), [("EPSG:32617", "x [m]"), ("EPSG:2263", "x [us-ft]")])
def test_terrain_has_the_unit_of_its_reference_system(crs, name, tmp_path):
    samples, unit = gm.sample(terrain(crs), 20), name[3:-1]
    assert header(samples, tmp_path)[0] == name
    report = samples.report
    assert report.unit == unit
    misfit = f"within {report.fit_distance:.3g} {unit} of the data (root mean square "
    assert f"{misfit}{report.fit_rms:.3g} {unit})" in samples.summary()


def test_no_unit_is_named_that_is_not_known(tmp_path):
    for surface in ("torus", terrain(None)):
        samples = gm.sample(surface, 20)
        assert header(samples, tmp_path)[:3] == ["x", "y", "z"]
        parquet = pytest.importorskip("pyarrow.parquet")
        samples.write(tmp_path / "a.parquet")
        assert b"unit_of_length" not in parquet.read_schema(tmp_path / "a.parquet").metadata
