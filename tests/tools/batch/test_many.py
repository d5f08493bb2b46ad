"""`sample_many`: the samples of several surfaces, aligned with these, also where some are bad."""

import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.batch.inputs import inputs_of
from gaussmap.tools.batch.making import limits_of

from ...refusals import refused
from ...shapes import BROKEN, TORUS
from .made import data_of, wait_until, waves


def many(*arguments: Any, **named: Any) -> list[Any]:
    return list(gm.sample_many(*arguments, progress=False, **named))


@pytest.mark.parametrize("asked", [{"count": 300}, {"normals": gm.icosphere(6)}])
def test_many_is_one_after_the_other(asked: dict[str, Any]):
    surfaces = [TORUS, gm.surfaces.sphere(), gm.fit(gm.surfaces.catenoid(), (16, 16))]
    found = many((x for x in surfaces), **asked)
    for samples, surface in zip(found, surfaces, strict=True):
        alone = gm.sample(surface, **asked)
        assert found[samples.report.index] is samples
        assert replace(samples.report, index=None) == alone.report
        np.testing.assert_array_equal(samples.points, alone.points)


def test_a_bad_surface_does_not_stop_the_others():
    surfaces = [gm.surfaces.sphere(), BROKEN, gm.surfaces.torus(), 3.0, gm.surfaces.catenoid()]
    with pytest.warns(gm.GaussmapWarning) as caught:
        found = many(surfaces, count=100, cells=(16, 16), on_error="skip")
    assert [samples.report.surface for samples in found] == ["sphere", "torus", "catenoid"]
    assert [samples.report.index for samples in found] == [0, 2, 4]
    messages = [str(warning.message) for warning in caught]
    assert len(messages) == 2
    assert messages[0].startswith("surface 1 (broken) is left out: the callable of surface")
    assert "RuntimeError: no such surface" in messages[0]
    assert messages[1].startswith(
        "surface 3 (float) is left out: a Surface or its name is needed, not float; "
    )


def test_an_error_takes_the_place_of_a_bad_surface():
    surfaces = [BROKEN, TORUS, 3.0]
    error, samples, other = many(surfaces, normals=[[1, 1, 1]], cells=(6, 6), on_error="return")
    assert isinstance(other, gm.errors.InputError)
    assert isinstance(error, gm.errors.SurfaceError)
    assert "no such surface" in str(error)
    assert error.__notes__ == ["This is surface 0 (broken) of sample_many."]
    assert samples.report.index == 1


def test_an_error_is_raised_with_the_number_of_the_surface():
    stream = gm.sample_many([TORUS, BROKEN], normals=[[1, 1, 1]], cells=(6, 6), progress=False)
    assert next(stream).report.index == 0
    with pytest.raises(gm.errors.SurfaceError, match="no such surface") as caught:
        next(stream)
    assert caught.value.__notes__ == ["This is surface 1 (broken) of sample_many."]
    error = gm.errors.UnknownNameError
    refused("on_error", many, [TORUS], count=10, on_error="ignore", error=error)


def test_other_errors_go_through():
    def surfaces():
        yield TORUS
        raise RuntimeError("the end of the file")

    stream = gm.sample_many(surfaces(), normals=[[1, 1, 1]], cells=(5, 5), progress=False)
    assert len(next(stream)) > 0
    refused("the end of the file", next, stream, error=RuntimeError)


@pytest.mark.parametrize("surfaces", [TORUS, None, "torus", 5])
def test_what_is_not_several_surfaces(surfaces):
    refused("sample_many takes an iterable of surfaces, not ", many, surfaces, count=10)


def test_many_of_nothing():
    assert many([], count=10) == []
    wrong: list[dict[str, Any]] = [{"count": 0}, {"normals": []}, {"count": 5, "threads": 0}]
    for asked in wrong:
        refused("", many, [], **asked)


# --- runs over many parts -------------------------------------------------------------------------

ASKED: dict[str, Any] = {"density": "uniform", "cells": (8, 8), "dtype": "float32"}


def doing(what: str) -> gm.Surface:
    """Return a surface that does something bad when it is evaluated."""

    def position(u, v):
        {
            "raises": lambda: 1 / 0,
            "hangs": lambda: time.sleep(1000),
            "exits": lambda: os._exit(3),
            "aborts": os.abort,
            "is killed": lambda: os.kill(os.getpid(), signal.SIGKILL),
            "takes all memory": lambda: np.ones(1 << 40),
            "takes all memory bit by bit": lambda: [*map(np.empty, repeat(1 << 24))],
        }[what]()
        return u

    return gm.Surface.from_callable(position, ((-1, 1), (-1, 1)), name=what)


def shared_memory() -> set[Path]:
    """Return what this machine's processes have in shared memory, semaphores among it."""
    return {*Path("/dev/shm").glob("*")}


def test_rows_of_what_is_sampled_and_what_fails(tmp_path):
    (tmp_path / "bad.npz").write_bytes(b"PK bad")
    np.save(
        tmp_path / "grid.npy",
        np.stack(np.meshgrid(*2 * [np.arange(9.0)], [0, 1.0])[:3], -1)[:, :, 0] ** 2,
    )
    bracket = gm.read_part(Path(gm.__path__[0]) / "docs" / "gallery" / "bracket.npz")
    parts = [waves(1), "torus", doing("raises"), tmp_path / "bad.npz", "missing.step",
             tmp_path / "grid.npy", bracket]  # fmt: skip
    out = tmp_path / "set"
    data = gm.sample_many(parts, 100, out=out, workers=1, progress=False, **ASKED)
    rows = data.manifest().to_pylist()
    assert [row["status"] for row in rows] == [*["ok"] * 2, *["failed"] * 3, *["ok"] * 2]
    assert [row["samples"] for row in rows] == [100, 100, 0, 0, 0, 100, 100]
    assert [row["parameters"] for row in rows] == ["", '{"major": 1.0, "minor": 0.35}', *5 * [""]]
    assert {row["angle"] for row in rows} == {None}  # it is not measured
    assert [row["unit_of_length"] for row in rows] == [*6 * [""], "mm"]
    assert "by zero" in rows[2]["error"]
    assert "damaged" in rows[3]["error"]
    assert "missing.step' does not exist" in rows[4]["error"]
    assert all(len(row["content"]) == 64 for row in rows if row["status"] == "ok")
    first = data_of(out)
    changed = {x: x.stat().st_mtime_ns for x in (out / "points").iterdir()}
    gm.sample_many(parts, 100, out=out, workers=2, progress=False, **ASKED)
    assert data_of(out) == first
    assert {x: x.stat().st_mtime_ns for x in (out / "points").iterdir()} == changed
    expected = gm.sample(parts[0], 100, fields=("points", "normals"), **ASKED)
    np.testing.assert_array_equal(data.samples(0).points, expected.points)
    np.testing.assert_array_equal(data.samples(0).normals, expected.normals)
    refused("count 100, not 101", gm.sample_many, parts, 101, out=out, progress=False, **ASKED)


def test_arguments(tmp_path):
    def sampled(parts: Any = ("torus",), **known: Any) -> object:
        return gm.sample_many(parts, 10, **known)  # pyright: ignore[reportCallIssue]

    out = tmp_path / "set"
    (tmp_path / "other").touch()
    refused("for data sets", sampled, workers=2)
    refused("on_error", sampled, out=out, on_error="skip")
    refused("workers must be a whole number", sampled, out=out, workers=0)
    refused("new or empty", sampled, out=tmp_path, error=gm.errors.FileError)
    assert not out.exists()
    refused("part 1 must be a Surface", sampled, ["torus", 5], out=out, progress=False)


@pytest.mark.parametrize("workers", [1, 7])
def test_all_workers_together_leave_memory_to_others(workers: int) -> None:
    installed = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    _, memory = limits_of(workers, 600.0, None)
    assert memory * workers == pytest.approx(limits_of(1, 600.0, None)[1])
    assert 0.0 < memory * workers < 0.92 * installed
    assert limits_of(workers, 600.0, 2.0) == (600.0, 2.0)


def test_names_that_are_no_text(tmp_path):
    (part,) = inputs_of([Path("a\udcff") / "b\udcff.step"])
    assert (part.name, part.source) == ("b\\udcff", "a\\udcff/b\\udcff.step")
    assert part.path == str(Path("a\udcff").absolute() / "b\udcff.step")


@pytest.mark.slow
class TestSlow:
    def test_what_ends_a_process_is_a_row(self, tmp_path):
        kinds = {
            "raises": "by zero", "hangs": "longer than time_limit (8 s)", "exits": "exit code 3",
            "is killed": "signal 9", "aborts": "signal 6", "takes all memory": "memory",
            "takes all memory bit by bit": "memory",
        }  # fmt: skip
        parts = [x for kind in kinds for x in (doing(kind), waves(len(kind)))]
        how: dict[str, Any] = ASKED | {"workers": 2, "time_limit": 8.0, "memory_limit": 1.0}
        for again in (False, True):
            rows = gm.sample_many(
                parts, 50, out=tmp_path / "set", progress=False, retry_failed=again, **how
            ).manifest().to_pylist()  # fmt: skip
            assert [row["status"] for row in rows] == ["failed", "ok"] * len(kinds)
            for row, text in zip(rows[::2], kinds.values(), strict=True):
                assert text in row["error"]

    def test_any_number_of_workers_gives_the_same_bytes(self, tmp_path):
        parts = [waves(k) for k in range(130)]
        for workers in (1, 2, 3):
            gm.sample_many(parts, 50, out=tmp_path / f"{workers}", workers=workers,
                           progress=False, **ASKED)  # fmt: skip
        assert data_of(tmp_path / "1") == data_of(tmp_path / "2") == data_of(tmp_path / "3")
        assert len(list((tmp_path / "1" / "points").iterdir())) == 130

    def test_a_surface_that_changed_is_sampled_again(self, tmp_path):
        log = tmp_path / "log"
        runs = ((1, 2, 3), {1, 2, 3}), ((1, 5, 3), {5}), ((1, 5, 3, 4), {4}), ((1, 5), set())
        for seeds, expected in runs:
            log.write_text("")
            data = gm.sample_many([waves(k, log=log) for k in seeds], 50, out=tmp_path / "set",
                                  progress=False, **ASKED)  # fmt: skip
            assert {int(x) for x in log.read_text().split()} == expected
            names = data.manifest()["name"].to_pylist()
            assert names == [f"waves {k}" for k in seeds]

    def test_a_generator_and_normals(self, tmp_path):
        data = gm.sample_many((waves(k) for k in range(70)), normals=gm.icosphere(8),
                              out=tmp_path / "set", progress=False, cells=(8, 8))  # fmt: skip
        assert len(data) == 70
        for k in (0, 69):
            expected = gm.sample(waves(k), normals=gm.icosphere(8), cells=(8, 8)).points
            np.testing.assert_array_equal(data.samples(k).points, expected)


PROGRAM = """
import sys
from pathlib import Path
import gaussmap as gm
from gaussmap.tests.tools.batch.made import waves

out = sys.argv[1]
gm.sample_many([waves(k, 0.01, Path(out + ".log")) for k in range(40)], 50, out=out, workers=2,
               density="uniform", cells=(8, 8), dtype="float32", progress=False)
"""


def started(tmp_path: Path, name: str = "set", first: str = "", **more: str) -> Any:
    """Start the program, after another line, that makes the data set of this name."""
    program = tmp_path / "program.py"
    program.write_text(first + PROGRAM)
    with open(tmp_path / "errors", "w") as errors:
        command = [sys.executable, str(program), str(tmp_path / name)]
        environment = os.environ | more
        return subprocess.Popen(command, stderr=errors, start_new_session=True, env=environment)


def goes_on(tmp_path: Path) -> None:
    """Check that the run ends with the bytes of one that nothing disturbed."""
    for name in ("set", "whole"):
        assert started(tmp_path, name).wait(60) == 0
    assert data_of(tmp_path / "set") == data_of(tmp_path / "whole")


def left_in(group: int) -> dict[int, str]:
    """Return the processes of a group that still run, and their commands."""
    listed = subprocess.run(["ps", "-eo", "pid,pgid,stat,args"], capture_output=True, text=True)
    rows = [line.split(None, 3) for line in listed.stdout.splitlines()[1:]]
    return {int(x[0]): x[3] for x in rows if x[1] == str(group) and not x[2].startswith("Z")}


def read_by_others(folder: Path) -> None:
    """Read what is finished of a data set; readers that take all files of a folder do, too."""
    polars = pytest.importorskip("polars")
    data = gm.open_dataset(folder)
    parts = data.manifest()["part"].to_pylist()
    if any((folder / "points").iterdir()):
        table = polars.scan_parquet(folder / "points" / "*.parquet").collect()
        assert {*table["part"]} == {*parts}


@pytest.mark.slow
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_ended_again_and_again_ends_with_the_same_bytes(tmp_path, kind):
    pause = random.Random(int(kind))
    for _ in range(20):
        process = started(tmp_path)
        time.sleep(pause.uniform(0.8, 3.0))
        process.send_signal(kind)
        code = process.wait(60)
        wait_until(lambda group=process.pid: not left_in(group))
        if code == 0:
            break
        if (tmp_path / "set" / "dataset.json").exists():
            read_by_others(tmp_path / "set")
    goes_on(tmp_path)
    # Each part is sampled once, but for those in work at the end of a run: one for each worker.
    assert len({*(tmp_path / "set.log").read_text().split()}) == 40


def with_some_sampled(tmp_path: Path, **more: str) -> Any:
    """Start a run, and return it when the first parts are sampled."""
    process = started(tmp_path, **more)
    wait_until((tmp_path / "set.log").exists)
    return process


@pytest.mark.slow
def test_processes_that_are_killed_cost_nothing(tmp_path):
    process = with_some_sampled(tmp_path)
    for number, what in left_in(process.pid).items():
        if "--process-name" in what:
            os.kill(number, signal.SIGKILL)
    assert process.wait(60) == 0
    goes_on(tmp_path)


@pytest.mark.slow
def test_a_run_that_is_killed_with_all_its_processes_leaves_nothing_outside(tmp_path):
    (tmp_path / "temporary").mkdir()
    before = shared_memory()
    process = with_some_sampled(tmp_path, TMPDIR=str(tmp_path / "temporary"))
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(60)
    assert not any((tmp_path / "temporary").iterdir())
    left = shared_memory() - before
    # Other tests that run meanwhile take away what they put there; what was leaked stays.
    wait_until(lambda: not left & shared_memory(), 120.0)


@pytest.mark.slow
def test_two_interrupts_leave_nothing_that_runs(tmp_path):
    process = with_some_sampled(tmp_path)
    for _ in range(2):
        process.send_signal(signal.SIGINT)
        time.sleep(0.05)
    assert process.wait(20) != 0
    wait_until(lambda: not left_in(process.pid), 20.0)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no limits")
def test_a_full_disk_is_one_sentence_and_the_run_goes_on_later(tmp_path):
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (2500, 2500))"
    assert started(tmp_path, first=limit).wait(120) == 1
    assert "cannot be written" in (tmp_path / "errors").read_text().splitlines()[-1]
    assert gm.open_dataset(tmp_path / "set").manifest().num_rows < 40
    goes_on(tmp_path)
