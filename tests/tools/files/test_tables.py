"""Tables in files: what pyarrow and pandas read, and text by Polars and without it."""

import io
import json
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.files import tables

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
