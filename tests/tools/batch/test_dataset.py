"""`Dataset`: what is in it, read by itself and by pandas, Polars and DuckDB."""

import subprocess
import sys

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.batch.folder import MANIFEST, part_path
from gaussmap.tools.batch.manifest import COLUMNS as MANIFEST_COLUMNS

from ...refusals import refused
from . import made

PARTS, SAMPLES = len(made.COUNTS), sum(made.COUNTS)


def columns_of(samples: gm.Samples) -> dict[str, np.ndarray]:
    """Return the columns of all fields that each part has."""
    vectors = (samples.points, ("x", "y", "z")), (samples.normals, ("nx", "ny", "nz"))
    columns = {name: x for array, names in vectors for name, x in zip(names, array.T, strict=True)}
    return columns | {x: getattr(samples, x) for x in ("gaussian_curvature", "normal_index")}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> gm.Dataset:
    return made.write(tmp_path_factory.mktemp("data") / "set")


def test_what_it_says_of_itself(dataset):
    assert len(dataset) == PARTS
    assert dataset.fields == made.FIELDS
    assert dataset.units == {"points": "L", "normals": "1", "gaussian_curvature": "1/L^2"}
    assert dataset.summary() == f"{PARTS} parts, 1 of which failed, with {SAMPLES} samples"
    assert repr(dataset) == f"Dataset('{dataset.folder}')"
    assert {dataset: 1}[gm.open_dataset(dataset.folder)] == 1


def test_manifest(dataset):
    table = dataset.manifest()
    assert table.column_names == list(MANIFEST_COLUMNS)
    assert table["part"].to_pylist() == list(range(PARTS))
    assert table["samples"].to_pylist() == list(made.COUNTS)
    assert table.schema.field("misfit").metadata[b"unit"] == b"L"
    assert dataset.manifest(["error", "part"]).to_pylist()[made.BROKEN] == {
        "error": "no such file.",
        "part": made.BROKEN,
    }


@pytest.mark.parametrize("part", [0, 1, 2, 3, 10])
def test_samples_of_a_part(dataset, part):
    found, expected = dataset.samples(part), made.samples_of(part, made.COUNTS[part])
    some = {"on_surface", "component", "face_index"} & {*found.fields}
    absent = set() if made.COUNTS[part] else some
    assert {*found.fields} - absent == {*expected.fields} - absent
    for name in expected.fields:
        assert getattr(found, name).flags.writeable
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), strict=True)
    assert (found.report.surface, found.report.index) == (f"part {part}", part)
    assert (found.report.fit_distance, found.report.samples) == (0.25, made.COUNTS[part])


INPUT_ERROR, UNKNOWN = gm.errors.InputError, gm.errors.UnknownNameError


@pytest.mark.parametrize(
    ("method", "asked", "error", "text"),
    [
        ("samples", made.BROKEN, UNKNOWN, "'broken'.*has failed: no such file"),
        ("samples", 13, UNKNOWN, "no part 13"),
        ("samples", 10**6, UNKNOWN, "no part"),
        ("samples", -1, INPUT_ERROR, "at least 0"),
        ("samples", "part 1", INPUT_ERROR, "whole number"),
        *(("manifest", x, INPUT_ERROR, "") for x in ("part", [], ["part", "part"], 3)),
        ("manifest", ["parts"], UNKNOWN, ""),
    ],
)
def test_what_is_not_there(dataset, method, asked, error, text):
    refused(text, getattr(dataset, method), asked, error=error)


def test_a_sequence(dataset):
    assert dataset[2].report == dataset.samples(2).report
    assert dataset[-3].report.index == PARTS - 3
    ok = [part for part in range(PARTS) if part != made.BROKEN]
    assert [samples.report.index for samples in dataset] == ok
    for part in (PARTS, made.BROKEN, -1):
        refused("", dataset.__getitem__, part, error=gm.errors.UnknownNameError)
    for part in (-PARTS - 1, "0", slice(2)):
        refused("", dataset.__getitem__, part)


def test_parts_are_seen_as_they_are_done(tmp_path):
    """While a run goes on, and after one that was killed, there is no manifest."""
    dataset = made.write(tmp_path)
    whole = dataset.manifest()
    (tmp_path / MANIFEST).unlink()
    assert dataset.manifest().equals(whole, check_metadata=True)
    part_path(tmp_path, 4).unlink()
    assert len(dataset) == len(dataset.manifest(["part"])) == PARTS - 1
    refused("", dataset.samples, 4, error=gm.errors.UnknownNameError)
    for part in range(PARTS):
        part_path(tmp_path, part).unlink(missing_ok=True)
    assert dataset.summary() == "0 parts with 0 samples"
    refused("no data set", gm.open_dataset, tmp_path / "points", error=gm.errors.FileError)
    refused("a path", gm.open_dataset, 3)


def test_reading_needs_no_numba(dataset):
    code = (
        "import sys, gaussmap as gm;"
        f"print(len(list(gm.open_dataset({str(dataset.folder)!r}).clouds(3))));"
        "assert not {'numba', 'sympy', 'scipy'} & {*sys.modules}"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == f"{len(made.HELD)}\n", done.stderr


@pytest.mark.parametrize("name", ["pandas", "polars"])
def test_other_readers(dataset, name):
    """Each reads what was written: columns, types, and what parts lack as null."""
    library = pytest.importorskip(name)
    table = library.read_parquet(f"{dataset.folder}/points/")
    held = [columns_of(made.samples_of(k, made.COUNTS[k])) for k in made.HELD]
    for column in held[0]:
        expected = np.concatenate([x[column] for x in held])
        np.testing.assert_array_equal(table[column].to_numpy(), expected, strict=True)
    parts = np.repeat(made.HELD, [made.COUNTS[k] for k in made.HELD])
    np.testing.assert_array_equal(table["part"].to_numpy(), parts, strict=True)
    absent = table["face_index"].isna() if name == "pandas" else table["face_index"].is_null()
    assert (~absent).sum() == sum(made.COUNTS[k] for k in made.HELD if k % 3 == 2)
    if name == "polars":
        assert table.schema["on_surface"] == library.Boolean
        assert table.schema["part"] == table.schema["face_index"] == library.Int64
    joined = table.merge if name == "pandas" else table.join
    manifest = library.read_parquet(dataset.folder / "manifest.parquet")
    assert manifest["samples"].to_list() == list(made.COUNTS)
    both = joined(manifest, on="part")
    assert (both["name"] == "part 2").sum() == made.COUNTS[2]


def test_single_precision(tmp_path):
    import pyarrow.parquet as parquet

    dataset = made.write(tmp_path, dtype="float32")
    found = dataset.samples(4)
    assert found.points.dtype == found.gaussian_curvature.dtype == np.float32
    assert found.normal_index.dtype == np.int64
    np.testing.assert_array_equal(found.points, made.samples_of(4, 70, "float32").points)
    column = parquet.ParquetFile(part_path(tmp_path, 0)).metadata.row_group(0).column(1)
    assert column.compression == "ZSTD"
    assert column.physical_type == "FLOAT"


def test_it_is_opened_again_after_pickling(dataset):
    import pickle

    assert len(pickle.loads(pickle.dumps(dataset)).manifest()) == PARTS
