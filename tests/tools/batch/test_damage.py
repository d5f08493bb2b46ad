"""Damaged data sets: each damage is one sentence that names the file, and no other exception."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.tools.batch.folder import MANIFEST, part_path, read_settings
from gaussmap.tools.batch.part_files import row_of

from ...refusals import refused
from . import made

pytestmark = pytest.mark.filterwarnings("ignore:part [0-9]+ has")

ASKED = {
    "count": 40, "angle": 3.0, "coverage": 0.5, "density": "uniform", "cells": [8, 9],
    "on": "surface", "normals": "5, SHA-256 0", "measured": False, "spacing": [30.0, -30.0],
    "set": [["minor", 0.5]], "crs": "EPSG:32617", "tolerance": 0.1, "band": 1,
}  # fmt: skip
NO_TEXT: tuple[Any, ...] = (None, 5, ["a"], {"a": 5}, False)
WRONG: dict[str, tuple[Any, ...]] = {
    "asked": (None, [], "count", 5, [["count", 5]]),
    "fields": (None, "points", [], ["points", "points"], ["pints"], [3], {"points": 1},
               ["other_uv"], [["points"]]),
    "dtype": (*NO_TEXT, "float16", ""),
    "gaussmap": NO_TEXT,
    "formulas": NO_TEXT,
    "format": (None, "3", 0, 1, [3], True),
}  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made.write(tmp_path_factory.mktemp("data") / "whole", asked=ASKED).folder


@pytest.fixture
def folder(whole: Path, tmp_path: Path) -> Path:
    """Return a data set to damage."""
    return Path(shutil.copytree(whole, tmp_path / "set"))


def used(folder: Path) -> list[str]:
    """Read a data set in every way; return the errors, which are sentences."""
    ways: list[Callable[[gm.Dataset], object]] = [
        lambda data: len(data),
        lambda data: data.summary(),
        lambda data: data.manifest(["name"]),
        *(lambda data, part=part: data[part] for part in made.HELD),
        lambda data: list(data.clouds(8, shuffle=1)),
    ]
    errors = []
    for way in ways:
        try:
            way(gm.open_dataset(folder))
        except gm.errors.GaussmapError as error:
            errors.append(str(error))
    for text in errors:
        assert len(text) <= 300
        assert "\n" not in text
        assert text.endswith(".")
    return errors


def with_settings(folder: Path, known: Any) -> str:
    """Return the error of opening a data set with other settings."""
    (folder / "dataset.json").write_text(json.dumps(known))
    said = r"dataset\.json' cannot be used"
    return refused(said, gm.open_dataset, folder, error=gm.errors.FileError)


def test_what_is_whole_is_read(folder: Path) -> None:
    assert used(folder) == []
    assert gm.open_dataset(folder).settings.asked == ASKED
    assert json.loads((folder / "dataset.json").read_text()).keys() == WRONG.keys()


@pytest.mark.parametrize("key", WRONG)
def test_each_entry_of_the_settings(folder: Path, key: str) -> None:
    known = json.loads((folder / "dataset.json").read_text())
    left = {name: value for name, value in known.items() if name != key}
    assert f"the entry {key} is missing" in with_settings(folder, left)
    assert f"did you mean {key}" in with_settings(folder, left | {key[:-1]: known[key]})
    assert "there is no entry 'more'" in with_settings(folder, known | {"more": 1})
    for wrong in WRONG[key]:
        text = with_settings(folder, known | {key: wrong})
        assert key.rstrip("s") in text or "another version" in text or "dictionary" in text, text


@pytest.mark.parametrize(
    "data", [b"", b"\0", b"\xff\xfe", b"PAR1", b"{", b"[1]", b"null", b"[" * 100_000, b'"text"']
)
def test_settings_that_are_no_json(folder: Path, data: bytes) -> None:
    (folder / "dataset.json").write_bytes(data)
    said = r"dataset.json' cannot be used: .*\.$"
    refused(said, gm.open_dataset, folder, error=gm.errors.FileError)


def test_settings_of_another_data_set(folder: Path) -> None:
    known = json.loads((folder / "dataset.json").read_text())
    for name, value in {"asked": {"count": 41}, "dtype": "float32"}.items():
        (folder / "dataset.json").write_text(json.dumps(known | {name: value}))
        assert any(".parquet' cannot be read" in text for text in used(folder))
    (folder / "dataset.json").unlink()
    (folder / "dataset.json").mkdir()
    refused(r"has no dataset\.json", gm.open_dataset, folder, error=gm.errors.FileError)


def arrow_file(path: Path) -> None:
    import pyarrow as arrow

    table = arrow.table({"part": [0, 1]})
    with arrow.OSFile(str(path), "wb") as file, arrow.ipc.new_file(file, table.schema) as writer:
        writer.write_table(table)


def another_table(path: Path) -> None:
    import pyarrow as arrow
    from pyarrow import parquet

    parquet.write_table(arrow.table({"part": ["a", None]}), path)


def directory(path: Path) -> None:
    path.unlink()
    path.mkdir()


def zeros(path: Path, start: int, stop: int) -> None:
    data = path.read_bytes()
    stop = stop % len(data)
    path.write_bytes(data[:start] + bytes(stop - start) + data[stop:])


DAMAGE: dict[str, Callable[[Path], object]] = {
    "empty": lambda path: path.write_bytes(b""),
    "half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "without its end": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "text": lambda path: path.write_text("points"),
    "zeros": lambda path: zeros(path, 0, -1),
    "zeros in the middle": lambda path: zeros(path, 100, -8),
    "an Arrow file": arrow_file,
    "another table": another_table,
    "a folder": directory,
    "the other kind": lambda path: shutil.copy(
        part_path(path.parent, 0) if path.name == MANIFEST else path.parents[1] / MANIFEST, path
    ),
    "another part": lambda path: shutil.copy(
        part_path(path.parent if path.name == MANIFEST else path.parents[1], 2), path
    ),
}


@pytest.mark.parametrize("name", [MANIFEST, "points/000004.parquet"])
@pytest.mark.parametrize("damage", DAMAGE)
def test_each_file(folder: Path, name: str, damage: str) -> None:
    path = folder / name
    DAMAGE[damage](path)
    errors = used(folder)
    assert errors
    assert all(f"'{path}'" in text and "again" in text for text in errors)
    # What the sentence asks for helps: the part is done again.
    assert (row_of(folder, read_settings(folder), 4) is None) is (name != MANIFEST)


def test_damaged_numbers_of_points(tmp_path: Path) -> None:
    """The end of the file, which is read first, is whole."""
    data = made.write(tmp_path)
    path = part_path(tmp_path, 4)
    zeros(path, 200, 900)
    assert str(path) in refused("cannot be read", data.samples, 4, error=gm.errors.FileError)
    assert data.samples(5).report.index == 5


def test_points_of_another_data_set(folder: Path, tmp_path: Path) -> None:
    other = made.write(tmp_path / "other")
    shutil.copy(part_path(other.folder, 0), part_path(folder, 0))
    another, error = "it is of another data set", gm.errors.FileError
    refused(another, gm.open_dataset(folder).samples, 0, error=error)


def test_copies_with_other_names_are_no_parts(folder: Path) -> None:
    (folder / MANIFEST).unlink()
    for name in ("000001 (copy).parquet", "000001x.parquet", "01.parquet"):
        shutil.copy(part_path(folder, 1), folder / "points" / name)
    assert used(folder) == []
    assert len(gm.open_dataset(folder)) == len(made.COUNTS)
