"""Damaged data sets: each damage is one sentence that names the file, and no other exception."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.tools.batch.folder import MANIFEST, POINTS, Settings, opened, shard_path
from gaussmap.tools.batch.shards import Shard

from . import made

pytest.importorskip("pyarrow")
pytestmark = pytest.mark.filterwarnings("ignore:part [0-9]+ has")

ASKED = {
    "count": 40, "angle": 3.0, "coverage": 0.5, "density": "uniform", "cells": [8, 9],
    "on": "surface", "normals": "5, SHA-256 0", "measured": False, "spacing": [30.0, -30.0],
    "set": [["minor", 0.5]], "crs": "EPSG:32617", "tolerance": 0.1, "band": 1,
}  # fmt: skip
NO_NUMBER: tuple[Any, ...] = (None, "5", [5], {"a": 5}, True)
NO_COUNT = (*NO_NUMBER, 2.5, 0, -1, float("nan"), 10**30)
NO_TEXT: tuple[Any, ...] = (None, 5, ["a"], {"a": 5}, False)
WRONG: dict[str, tuple[Any, ...]] = {
    "asked": (None, [], "count", 5, [["count", 5]]),
    "fields": (None, "points", [], ["points", "points"], ["pints"], [3], {"points": 1},
               ["other_uv"], [["points"]]),
    "dtype": (*NO_TEXT, "float16", ""),
    "compression": (*NO_TEXT, "zip"),
    "parts_per_shard": (*NO_COUNT, 257),
    "files": (5, [], True),
    "gaussmap": NO_TEXT,
    "formulas": NO_TEXT,
    "format": (None, "2", 0, 1, [2], True),
}  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "whole"
    made.write(folder)
    known = json.loads((folder / "dataset.json").read_text())
    (folder / "dataset.json").write_text(json.dumps(known | {"asked": ASKED}))
    return folder


@pytest.fixture
def folder(whole: Path, tmp_path: Path) -> Path:
    """Return a data set to damage."""
    return Path(shutil.copytree(whole, tmp_path / "set"))


def used(folder: Path) -> list[str]:
    """Read a data set in every way; return the errors, which are sentences."""
    ways: list[Callable[[gm.Dataset], object]] = [
        len,
        lambda data: data.summary(),
        lambda data: data.manifest(["name"]),
        *(lambda data, part=part: data.samples(part) for part in made.HELD),
        lambda data: list(data.batches(8)),
        lambda data: list(data.batches(8, shuffle=1, labels="samples")),
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


def refused(folder: Path, known: Any) -> str:
    """Return the error of opening a data set with other settings."""
    (folder / "dataset.json").write_text(json.dumps(known))
    with pytest.raises(gm.errors.FileError, match=r"dataset\.json' cannot be used") as error:
        gm.open_dataset(folder)
    assert len(str(error.value)) <= 300
    return str(error.value)


def test_what_is_whole_is_read(folder: Path) -> None:
    assert used(folder) == []
    assert gm.open_dataset(folder).settings.asked == ASKED
    known = json.loads((folder / "dataset.json").read_text())
    assert known.keys() == WRONG.keys()


@pytest.mark.parametrize("key", WRONG)
def test_each_entry_of_the_settings(folder: Path, key: str) -> None:
    known = json.loads((folder / "dataset.json").read_text())
    left = {name: value for name, value in known.items() if name != key}
    assert f"the entry {key} is missing" in refused(folder, left)
    assert f"did you mean {key}" in refused(folder, left | {key[:-1]: known[key]})
    assert "there is no entry 'more'" in refused(folder, known | {"more": 1})
    for wrong in WRONG[key]:
        text = refused(folder, known | {key: wrong})
        assert key.rstrip("s") in text or "another version" in text or "dictionary" in text, text


@pytest.mark.parametrize(
    "data", [b"", b"\0", b"\xff\xfe", b"PAR1", b"{", b"[1]", b"null", b"[" * 100_000, b'"text"']
)
def test_settings_that_are_no_json(folder: Path, data: bytes) -> None:
    (folder / "dataset.json").write_bytes(data)
    with pytest.raises(gm.errors.FileError, match=r"dataset.json' cannot be used: .*\.$"):
        gm.open_dataset(folder)


def test_settings_of_other_shards(folder: Path) -> None:
    known = json.loads((folder / "dataset.json").read_text())
    for name, value in {"parts_per_shard": 4, "dtype": "float32"}.items():
        (folder / "dataset.json").write_text(json.dumps(known | {name: value}))
        assert any(".parquet' cannot be read" in text for text in used(folder))
    (folder / "dataset.json").unlink()
    (folder / "dataset.json").mkdir()
    with pytest.raises(gm.errors.FileError, match=r"has no dataset\.json"):
        gm.open_dataset(folder)


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


DAMAGE: dict[str, Callable[[Path], object]] = {
    "empty": lambda path: path.write_bytes(b""),
    "half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "without its end": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "text": lambda path: path.write_text("points"),
    "zeros": lambda path: path.write_bytes(bytes(path.stat().st_size)),
    "zeros in the middle": lambda path: path.write_bytes(
        path.read_bytes()[:100] + bytes(path.stat().st_size - 108) + path.read_bytes()[-8:]
    ),
    "an Arrow file": arrow_file,
    "another table": another_table,
    "a folder": directory,
    "the other kind": lambda path: shutil.copy(
        path.parent.parent / ({POINTS, MANIFEST} - {path.parent.name}).pop() / path.name, path
    ),
    "another shard": lambda path: shutil.copy(path.with_name("shard-000002.parquet"), path),
}


@pytest.mark.parametrize("kind", [POINTS, MANIFEST])
@pytest.mark.parametrize("damage", DAMAGE)
def test_each_file(folder: Path, kind: str, damage: str) -> None:
    path = shard_path(folder, kind, 1)
    DAMAGE[damage](path)
    errors = used(folder)
    assert errors
    assert all(f"'{path}'" in text for text in errors)
    settings = gm.open_dataset(folder).settings
    if path.is_file():  # and what the sentence asks for helps
        shard = Shard(folder, 1, settings)
        assert not shard.rows


def test_swapped_files(folder: Path) -> None:
    points, manifest = (shard_path(folder, kind, 0) for kind in (POINTS, MANIFEST))
    kept = points.read_bytes()
    points.write_bytes(manifest.read_bytes())
    manifest.write_bytes(kept)
    assert "does not have the columns of manifest" in used(folder)[0]


def test_damaged_numbers_of_points(folder: Path) -> None:
    """The end of the file, which is read first, is whole."""
    path = shard_path(folder, POINTS, 0)
    data = path.read_bytes()
    path.write_bytes(data[:4] + bytes(500) + data[504:])
    assert any(f"'{path}' cannot be read" in text for text in used(folder))


def test_points_of_another_data_set(folder: Path, tmp_path: Path) -> None:
    other = made.write(tmp_path / "other", (10, *made.COUNTS[1:]))
    shutil.copy(shard_path(other.folder, POINTS, 0), shard_path(folder, POINTS, 0))
    with pytest.raises(gm.errors.FileError, match="does not belong to its manifest"):
        gm.open_dataset(folder).samples(0)


def test_copies_with_other_names_are_no_shards(folder: Path) -> None:
    for kind in (POINTS, MANIFEST):
        for name in ("shard-000001 (copy).parquet", "shard-000001x.parquet", "shard-01.parquet"):
            shutil.copy(shard_path(folder, kind, 1), folder / kind / name)
    assert used(folder) == []
    assert len(gm.open_dataset(folder)) == len(made.COUNTS)


class TestLinks:
    def settings(self) -> Settings:
        return Settings.of_this_version({}, made.FIELDS, parts_per_shard=made.SEPARATE)

    @pytest.mark.parametrize(
        "name", ["points", "manifest", "partial", "files", "normals.npy", ".lock", "dataset.json",
                 "points/shard-000000.parquet", "partial/shard-000000.arrow", "files/000000.ply"],
    )  # fmt: skip
    @pytest.mark.parametrize("overwrite", [False, True])
    def test_are_refused_before_anything_is_written(
        self, tmp_path: Path, name: str, overwrite: bool
    ) -> None:
        folder, target = tmp_path / "set", tmp_path / "elsewhere"
        made.write(folder)
        (folder / "files").mkdir()
        if (folder / name).exists():
            (folder / name).rename(target)
        (folder / name).symlink_to(target)
        before = contents(tmp_path)
        with (
            pytest.raises(gm.errors.FileError, match=f"{name}' is a symbolic link"),
            opened(folder, self.settings(), overwrite),
        ):
            pass
        assert contents(tmp_path) == before

    def test_the_folder_itself_may_be_one(self, tmp_path: Path) -> None:
        (tmp_path / "disk").mkdir()
        (tmp_path / "set").symlink_to("disk")
        with opened(tmp_path / "set", self.settings()):
            pass
        assert (tmp_path / "disk" / "dataset.json").is_file()


def contents(folder: Path) -> dict[str, Any]:
    """Return what lies in a folder: the bytes of files, and where links lead."""
    return {
        str(x): x.readlink() if x.is_symlink() else x.read_bytes() if x.is_file() else None
        for x in sorted(folder.rglob("*"))
    }
