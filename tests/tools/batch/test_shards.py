"""Shards of a data set: what is kept after a kill at any moment, and the same bytes in the end."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.batch.data_files import points_table
from gaussmap.tools.batch.folder import (
    MANIFEST,
    PARTIAL,
    POINTS,
    Settings,
    create,
    opened,
    parts_per_shard,
    read_settings,
    remove_from,
    replaced,
    shard_path,
)
from gaussmap.tools.batch.manifest import FAILED, ManifestRow, manifest_table, rows_of
from gaussmap.tools.batch.shards import Shard, part_path, read_part

from ...refusals import refused

pytest.importorskip("pyarrow")
FIELDS = ("points", "normals", "on_surface", "face_index")
COUNTS = {0: 3, 1: 0, 2: 70_000, 3: 70_000, 4: 5}


def settings(**known) -> Settings:
    return Settings.of_this_version(asked={"count": 5}, fields=FIELDS, dtype="float32", **known)


def samples(part: int, count: int) -> gm.Samples:
    rng = np.random.default_rng(part)
    vectors: dict[str, Any] = {
        name: rng.normal(size=(count, 3)).astype(np.float32) for name in ("points", "normals")
    }
    return gm.Samples(
        **vectors,
        face_index=rng.integers(9, size=count) if part % 2 else None,
        report=SamplingReport(surface="a", normals=None, samples=count, patches=None,
                              developable_share=None, developable_patches=None),
    )  # fmt: skip


def row(part: int, content: str = "1") -> ManifestRow:
    return ManifestRow(part, f"part {part}", "Surface", content, samples=COUNTS[part], seconds=part)


def add(shard: Shard, part: int, content: str = "1") -> None:
    table = points_table(samples(part, COUNTS[part]), part, shard.schema)
    shard.add(row(part, content), table)


def folder(path: Path, **known) -> tuple[Path, Settings]:
    return path, create(path, settings(**known))


def finished(path: Path) -> dict[str, bytes]:
    return {kind: shard_path(path, kind, 0).read_bytes() for kind in (POINTS, MANIFEST)}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory) -> dict[str, bytes]:
    path, known = folder(tmp_path_factory.mktemp("whole") / "set")
    shard = Shard(path, 0, known)
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    return finished(path)


def test_what_is_written_is_read(tmp_path):
    import pyarrow.parquet as parquet

    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    assert not any((path / PARTIAL).iterdir())
    table = parquet.read_table(shard_path(path, POINTS, 0))
    np.testing.assert_array_equal(
        table["part"], np.repeat(list(COUNTS), list(COUNTS.values())), strict=False
    )
    third = table.slice(3, COUNTS[2])
    np.testing.assert_array_equal(third["nx"], samples(2, COUNTS[2]).normals[:, 0])
    assert third["face_index"].null_count == COUNTS[2]
    assert table.slice(3 + COUNTS[2], COUNTS[3])["face_index"].null_count == 0
    assert rows_of(parquet.read_table(shard_path(path, MANIFEST, 0))) == [row(x) for x in COUNTS]
    groups = parquet.ParquetFile(shard_path(path, POINTS, 0)).metadata
    assert groups.num_row_groups == 2  # 70,003 samples, and 70,005


def test_any_order_and_any_interruption_end_with_the_same_bytes(tmp_path, undisturbed):
    path, known = folder(tmp_path)
    for part in (3, 0, 4):
        shard = Shard(path, 0, known)
        shard.add(replace(row(4), content="old")) if part == 4 else add(shard, part)
    add(Shard(path, 0, known), 4)
    shard = Shard(path, 0, known)
    assert list(shard.rows) == [0, 3, 4]
    assert shard.rows[4].content == "1"
    add(shard, 1)
    add(shard, 2)
    shard.commit(list(COUNTS))
    assert finished(path) == undisturbed


@pytest.mark.parametrize("left", [0, 1, 100, 0.3, 0.9, 0.999])
def test_a_part_that_is_cut_is_done_again(tmp_path, undisturbed, left):
    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    add(shard, 0)
    add(shard, 2)
    data = part_path(path, 2).read_bytes()
    size = left if isinstance(left, int) else int(left * len(data))
    part_path(path, 2).write_bytes(data[:size])
    shard = Shard(path, 0, known)
    assert list(shard.rows) == [0]
    for part in COUNTS:
        if part not in shard.rows:
            add(shard, part)
    shard.commit(list(COUNTS))
    assert finished(path) == undisturbed


@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.slow)])
def test_cut_at_any_byte(tmp_path, step):
    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    add(shard, 0)
    add(shard, 4)
    data = part_path(path, 4).read_bytes()
    for size in range(0, len(data), step):
        part_path(path, 4).write_bytes(data[:size])
        assert read_part(path, 4, shard.schema) is None, size
    part_path(path, 4).write_bytes(data)
    assert list(Shard(path, 0, known).rows) == [0, 4]


def test_a_kill_between_points_and_manifest(tmp_path, undisturbed, monkeypatch):
    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    shard_path(path, MANIFEST, 0).unlink()
    shard = Shard(path, 0, known)
    assert not shard.rows
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    assert finished(path) == undisturbed


def test_a_part_that_changed_is_replaced_and_the_others_are_kept(tmp_path, undisturbed):
    import pyarrow.parquet as parquet

    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    seen = shard_path(path, POINTS, 0).stat().st_mtime_ns
    shard.commit(list(COUNTS))
    assert shard_path(path, POINTS, 0).stat().st_mtime_ns == seen  # nothing to do
    shard = Shard(path, 0, known)
    assert len(shard.rows) == len(COUNTS)
    shard.add(row(4, "2"), points_table(samples(9, 5), 4, shard.schema))
    shard.commit(list(COUNTS))
    table = parquet.read_table(shard_path(path, POINTS, 0))
    np.testing.assert_array_equal(table["x"][-5:], samples(9, 5).points[:, 0])
    shard = Shard(path, 0, known)
    assert shard.rows[4].content == "2"
    add(shard, 4)
    shard.commit(list(COUNTS))
    assert finished(path) == undisturbed
    shard = Shard(path, 0, known)  # the list has become shorter
    shard.commit([0, 1])
    assert parquet.read_table(shard_path(path, POINTS, 0)).num_rows == COUNTS[0]


def test_parts_without_samples(tmp_path):
    path, known = folder(tmp_path)
    bad = replace(row(1), status=FAILED, error="no such file.", misfit=0.5)
    shard = Shard(path, 0, known)
    shard.add(bad)
    shard.commit([1])
    assert Shard(path, 0, known).rows == {1: bad}


@pytest.mark.parametrize("data", [b"", b"PAR1", bytes(1000), b"not arrow" * 100])
def test_damaged_files_are_done_again(tmp_path, undisturbed, data):
    path, known = folder(tmp_path)
    for file in (*(shard_path(path, kind, 0) for kind in (POINTS, MANIFEST)), part_path(path, 2)):
        file.write_bytes(data)
    shard = Shard(path, 0, known)
    assert not shard.rows
    for part in COUNTS:
        add(shard, part)
    shard.commit(list(COUNTS))
    assert finished(path) == undisturbed


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let no process write a larger file: as if the disk were full."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


class TestFullDisk:
    def test_what_is_done_stays_and_parts_follow_it(self, tmp_path, undisturbed):
        path, known = folder(tmp_path)
        shard = Shard(path, 0, known)
        add(shard, 0)
        with files_of_at_most(10_000):
            for _ in range(2):
                refused("what is done is kept", add, shard, 2, error=gm.errors.FileError)
        assert list(Shard(path, 0, known).rows) == list(shard.rows) == [0]
        for part in (1, 2, 3, 4):  # there is room again
            add(shard, part)
        shard.commit(list(COUNTS))
        assert finished(path) == undisturbed

    def test_the_error_is_not_hidden_by_closing(self, tmp_path):
        path, known = folder(tmp_path)
        with (
            pytest.raises(gm.errors.FileError, match="File too large; what is done"),
            files_of_at_most(5000),
        ):
            add(Shard(path, 0, known), 2)
        assert not Shard(path, 0, known).rows

    def test_while_the_shard_is_finished(self, tmp_path, undisturbed):
        path, known = folder(tmp_path)
        shard = Shard(path, 0, known)
        for part in COUNTS:
            add(shard, part)
        for size in (100, 1000, 100_000):
            with (
                files_of_at_most(size),
                pytest.raises(gm.errors.FileError, match="what is done is kept"),
            ):
                shard.commit(list(COUNTS))
            assert not list((path / POINTS).iterdir()) + list((path / MANIFEST).iterdir())
            names = sorted(x.name for x in (path / PARTIAL).iterdir())
            assert names == [f"{part:06d}.arrow" for part in COUNTS]
        shard.commit(list(COUNTS))
        assert finished(path) == undisturbed

    def test_for_the_manifest_only(self, tmp_path, undisturbed, monkeypatch):
        def full(*_, **__) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        path, known = folder(tmp_path)
        shard = Shard(path, 0, known)
        with monkeypatch.context() as patched:
            for part in COUNTS:
                add(shard, part)
            patched.setattr("pyarrow.parquet.write_table", full)
            refused("what is done is kept", shard.commit, list(COUNTS), error=gm.errors.FileError)
        shard = Shard(path, 0, known)
        assert list(shard.rows) == list(COUNTS)  # nothing has to be done again
        shard.commit(list(COUNTS))
        assert finished(path) == undisturbed


def test_large_parts_have_the_same_bytes_however_they_were_read(tmp_path):
    path, known = folder(tmp_path)
    count = 300_000  # several pages of the Parquet file

    def large(part: int) -> ManifestRow:
        return replace(row(0), part=part, samples=count)

    seen = []
    shard = Shard(path, 0, known)
    for part in (1, 2):
        shard.add(large(part), points_table(samples(part, count), part, shard.schema))
    shard.commit([1, 2])
    seen.append(finished(path))
    shard = Shard(path, 0, known)  # of which one is read from the Parquet file
    shard.add(large(2), points_table(samples(2, count), 2, shard.schema))
    shard.commit([1, 2])
    seen.append(finished(path))
    assert seen[0] == seen[1]


def test_cad_parts_have_no_patches(tmp_path):
    known = Settings.of_this_version(asked={}, fields=("points", "normals", "patch_index"))
    data = create(tmp_path, known)
    shard = Shard(tmp_path, 0, data)
    for part, patches in enumerate((None, np.arange(5))):
        vectors: dict[str, Any] = dict.fromkeys(("points", "normals"), np.ones((5, 3)))
        some = gm.Samples(**vectors, patch_index=patches, report=samples(0, 5).report)  # pyright: ignore[reportArgumentType]
        shard.add(
            ManifestRow(part, "a", "b", "c", samples=5), points_table(some, part, shard.schema)
        )
    shard.commit([0, 1])
    read = gm.open_dataset(tmp_path)
    assert read.samples(0).fields == ("points", "normals")
    np.testing.assert_array_equal(read.samples(1).patch_index, np.arange(5))


def test_names_that_are_no_text(tmp_path):
    path, known = folder(tmp_path)
    shard = Shard(path, 0, known)
    shard.add(replace(row(1), name="part\udcff.step", source="\0\n"))
    shard.commit([1])
    assert Shard(path, 0, known).rows[1].name == "part\\udcff.step"


def test_rows_survive_json_and_arrow():
    rows = [row(0), replace(row(1), misfit=float("inf"), warnings="é\n'", angle=1e-300)]
    assert rows_of(manifest_table(rows)) == rows


class TestFolder:
    def test_settings(self, tmp_path):
        path, known = folder(tmp_path / "new" / "set")
        assert read_settings(path) == known
        assert create(path, replace(known, parts_per_shard=3)) == known

    def test_settings_are_compared_as_they_are_read(self, tmp_path):
        known = replace(settings(), asked={"cells": (16, 16), "nodata": float("nan")})
        assert create(tmp_path, known).asked == known.asked
        assert repr(create(tmp_path, known).asked) == "{'cells': [16, 16], 'nodata': nan}"

    @pytest.mark.parametrize(
        ("change", "what"),
        [
            ({"compression": "none"}, 'compression="zstd", not "none"'),
            ({"asked": {"count": 6}}, "count=5, not 6"),
            ({"dtype": "float64"}, 'dtype="float32", not "float64"'),
            ({"formulas": "other"}, "another version"),
            ({"asked": {"count": 5, "angle": 3.0}}, "angle=null, not 3.0"),
        ],
    )
    def test_other_settings(self, tmp_path, change, what):
        path, known = folder(tmp_path)
        said = refused("another folder", create, path, replace(known, **change))
        assert what in said
        assert create(path, replace(known, **change), overwrite=True) == replace(known, **change)

    def test_overwrite_leaves_what_is_not_of_the_data_set(self, tmp_path):
        path, known = folder(tmp_path)
        (path / "notes.txt").write_text("mine")
        shard = Shard(path, 0, known)
        add(shard, 0)
        shard.commit([0])
        create(path, known, overwrite=True)
        assert (path / "notes.txt").read_text() == "mine"
        assert not any((path / POINTS).iterdir())

    def test_folders_of_something_else(self, tmp_path):
        (tmp_path / "a").write_text("b")
        for overwrite in (False, True):
            with pytest.raises(gm.errors.FileError, match="new or empty folder"):
                create(tmp_path, settings(), overwrite)
        refused("is a file", create, tmp_path / "a", settings(), error=gm.errors.FileError)
        refused("no data set", read_settings, tmp_path, error=gm.errors.FileError)

    @pytest.mark.parametrize("text", ["", "{}", "[1]", '{"format": 99}', "\0"])
    def test_damaged_settings(self, tmp_path, text):
        path, known = folder(tmp_path)
        (path / "dataset.json").write_text(text)
        refused("cannot be used", create, path, known, error=gm.errors.FileError)
        refused("not of gaussmap", create, path, known, overwrite=True, error=gm.errors.FileError)
        assert (path / POINTS).exists()

    @pytest.mark.parametrize("overwrite", [False, True])
    def test_one_run_at_a_time(self, tmp_path, overwrite):
        path = tmp_path / "new"
        with opened(path, settings()) as known:
            shard = Shard(path, 0, known)
            add(shard, 0)
            shard.commit([0])
            with (
                pytest.raises(gm.errors.FileError, match="another run"),
                opened(path, known, overwrite),
            ):
                pass
            assert Shard(path, 0, known).rows
        with opened(path, known, overwrite):
            assert bool(Shard(path, 0, known).rows) is not overwrite

    def test_a_kill_while_the_folder_is_made(self, tmp_path):
        (tmp_path / ".gaussmap-0123.json").write_text("{")
        (tmp_path / ".lock").touch()
        with opened(tmp_path, settings()) as known:
            for kind in (POINTS, MANIFEST, PARTIAL):
                (tmp_path / kind).rmdir()
        with opened(tmp_path, known):
            assert (tmp_path / PARTIAL).is_dir()

    def test_what_a_killed_run_was_writing_is_removed(self, tmp_path):
        path, known = folder(tmp_path)
        with replaced(path, path / POINTS / "a.parquet") as temporary:
            assert temporary.parent == path / PARTIAL
            temporary.touch()
            (path / PARTIAL / f"0{temporary.name}").write_bytes(b"PAR1")
        with opened(path, known):
            assert not any((path / PARTIAL).iterdir())

    def test_shards_of_a_longer_list_are_removed(self, tmp_path):
        path, known = folder(tmp_path, parts_per_shard=2)
        for number in (6, 7, 1_234_567):
            first, second = (replace(row(1), part=2 * number + k) for k in (0, 1))
            shard = Shard(path, number, known)
            shard.add(first)
            shard.commit([first.part])
            shard.add(second)
        (path / POINTS / "mine.txt").touch()
        remove_from(path, 7, 14)
        left = [x.name for kind in (POINTS, MANIFEST, PARTIAL) for x in (path / kind).iterdir()]
        assert sorted(left) == ["000013.arrow", "mine.txt", *2 * ["shard-000006.parquet"]]

    def test_parts_per_shard(self):
        assert parts_per_shard(200, 2048) == 3
        assert parts_per_shard(10, None) == 1
        assert parts_per_shard(10**6, 2048) == 256
        assert parts_per_shard(10**6, 10**6) == 4
        assert parts_per_shard(None, 10**9) == 1
