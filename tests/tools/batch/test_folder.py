"""The folder of a data set: whose it is, who writes to it, and what kills leave there."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.tools.batch.folder import (
    MANIFEST,
    PARTIAL,
    POINTS,
    opened,
    part_path,
    parts_in,
    read_settings,
    remove_from,
    replaced,
)  # fmt: skip
from gaussmap.tools.batch.manifest import FAILED, ManifestRow
from gaussmap.tools.batch.part_files import row_of, write_part

from ...full_disk import tiny_disk
from ...refusals import refused
from . import made

KNOWN = made.settings(asked={"count": 5})


def begin(path: Path, overwrite: bool = False, **changes: Any) -> None:
    with opened(path, replace(KNOWN, **changes), overwrite):
        pass


def contents(folder: Path) -> dict[str, Any]:
    """Return what lies in a folder: the bytes of files, and where links lead."""
    return {
        str(x): x.readlink() if x.is_symlink() else x.read_bytes() if x.is_file() else None
        for x in sorted(folder.rglob("*"))
    }


@pytest.mark.parametrize(
    "row",
    [
        ManifestRow(1, "a", "b", "c", FAILED, error="no such file.", misfit=0.5),
        ManifestRow(1, "é\n'", "\\udcff", misfit=float("inf"), warnings="é\n'", angle=1e-300),
    ],
)
def test_rows_are_read_as_they_were_written(tmp_path: Path, row: ManifestRow) -> None:
    with opened(tmp_path, KNOWN):
        write_part(tmp_path, KNOWN, row)
    assert row_of(tmp_path, KNOWN, 1) == row
    (read,) = gm.open_dataset(tmp_path).manifest().to_pylist()
    assert ManifestRow(**read) == row


def test_names_that_are_no_text(tmp_path: Path) -> None:
    with opened(tmp_path, KNOWN):
        write_part(tmp_path, KNOWN, ManifestRow(0, "part\udcff.step", "\0\n"))
    assert gm.open_dataset(tmp_path).manifest()["name"].to_pylist() == ["part\\udcff.step"]


def test_a_full_disk_leaves_what_is_done(tmp_path: Path) -> None:
    made.write(tmp_path)
    known, before = read_settings(tmp_path), contents(tmp_path)
    with opened(tmp_path, known):
        for _ in range(2):
            with tiny_disk(4_000):
                given = tmp_path, known, made.row_of(3, 900), made.samples_of(3, 900)
                refused("what is done is kept", write_part, *given, error=gm.errors.FileError)
    before.pop(str(tmp_path / MANIFEST))
    assert contents(tmp_path) == before


def test_settings_are_compared_as_they_are_read(tmp_path: Path) -> None:
    for _ in range(2):
        begin(tmp_path / "new" / "set", asked={"cells": (16, 16), "nodata": float("nan")})
    known = read_settings(tmp_path / "new" / "set")
    assert repr(known.asked) == "{'cells': [16, 16], 'nodata': nan}"


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"asked": {"count": 6}}, "count 5, not 6"),
        ({"dtype": "float32"}, 'dtype "float64", not "float32"'),
        ({"formulas": "other"}, "another version"),
        ({"asked": {"count": 5, "angle": 3.0}}, "angle null, not 3.0"),
    ],
)
def test_other_settings(tmp_path: Path, change: dict[str, Any], what: str) -> None:
    made.write(tmp_path, asked={"count": 5})
    (tmp_path / "notes.txt").write_text("mine")
    before = contents(tmp_path)
    assert what in refused("another folder", begin, tmp_path, **change)
    assert contents(tmp_path) == before
    begin(tmp_path, overwrite=True, **change)
    assert read_settings(tmp_path) == replace(KNOWN, **change)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert not parts_in(tmp_path)


@pytest.mark.parametrize("overwrite", [False, True])
def test_folders_of_something_else(tmp_path: Path, overwrite: bool) -> None:
    (tmp_path / "a").write_text("b")
    refused("new or empty folder", begin, tmp_path, overwrite, error=gm.errors.FileError)
    refused("is a file", begin, tmp_path / "a", overwrite, error=gm.errors.FileError)
    refused("no data set", read_settings, tmp_path, error=gm.errors.FileError)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"format": 99}', "\0"])
def test_damaged_settings(tmp_path: Path, text: str) -> None:
    made.write(tmp_path)
    (tmp_path / "dataset.json").write_text(text)
    before = contents(tmp_path)
    for overwrite, match in ((False, "cannot be used"), (True, "not of gaussmap")):
        refused(match, begin, tmp_path, overwrite, error=gm.errors.FileError)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("overwrite", [False, True])
def test_one_run_at_a_time(tmp_path: Path, overwrite: bool) -> None:
    with opened(tmp_path, KNOWN):
        write_part(tmp_path, KNOWN, made.row_of(made.BROKEN, 0))
        refused("another run", begin, tmp_path, overwrite, error=gm.errors.FileError)
        assert parts_in(tmp_path)
    begin(tmp_path, overwrite)
    assert bool(parts_in(tmp_path)) is not overwrite


def test_what_killed_runs_leave_is_removed(tmp_path: Path) -> None:
    for name in (".gaussmap-0123.json", ".lock"):  # of one that was killed at once
        (tmp_path / name).write_text("{")
    begin(tmp_path)
    with opened(tmp_path, KNOWN), replaced(tmp_path, part_path(tmp_path, 0)) as temporary:
        assert temporary.parent == tmp_path / PARTIAL
        temporary.touch()
        temporary.with_name("a").write_bytes(b"PAR1")
    begin(tmp_path)
    left = sorted(str(x.relative_to(tmp_path)) for x in tmp_path.rglob("*"))
    assert left == [".lock", "dataset.json", "points", "points/000000.parquet"]


def test_parts_of_a_longer_list_are_removed(tmp_path: Path) -> None:
    (tmp_path / POINTS).mkdir()
    for part in (13, 14, 1_234_567):
        part_path(tmp_path, part).touch()
    (tmp_path / POINTS / "mine.txt").touch()
    remove_from(tmp_path, 14)
    left = sorted(x.name for x in (tmp_path / POINTS).iterdir())
    assert left == ["000013.parquet", "mine.txt"]


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize(
    "name", [POINTS, PARTIAL, MANIFEST, "normals.npy", ".lock", "dataset.json",
             "points/000001.parquet", "partial/a"],
)  # fmt: skip
def test_links_are_refused(tmp_path: Path, name: str, overwrite: bool) -> None:
    folder, target = tmp_path / "set", tmp_path / "elsewhere"
    made.write(folder)
    (folder / PARTIAL).mkdir()
    if (folder / name).exists():
        (folder / name).rename(target)
    (folder / name).symlink_to(target)
    before = contents(tmp_path)
    refused(f"{name}' is a symbolic link", begin, folder, overwrite, error=gm.errors.FileError)
    assert contents(tmp_path) == before


def test_the_folder_itself_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "set").symlink_to("disk")
    begin(tmp_path / "set")
    assert (tmp_path / "disk" / "dataset.json").is_file()
