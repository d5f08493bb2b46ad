"""The command `gaussmap batch`: lists of parts, what is reported, exit codes."""

import json
import subprocess
import sys
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.commands.cli import main
from gaussmap.tools.commands.part_lists import listed

pytest.importorskip("pyarrow")
SMALL = ["--cells", "8", "8", "--count", "50", "--density", "uniform", "--float32"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_run_and_the_same_again(capfd: pytest.CaptureFixture[str]) -> None:
    Path("list.txt").write_text("# two parts\n\nsphere\nmissing.step\n")
    command = ["batch", "torus", "--list", "list.txt", *SMALL, "-o", "set", "--workers", "1"]
    assert main(command) == 3
    out, err = capfd.readouterr()
    assert "set: 100 samples of 3 parts" in out
    assert "missing.step' does not exist" in out
    assert "--retry-failed" in out
    assert err == ""
    assert main([*command, "--json"]) == 3
    told = json.loads(capfd.readouterr().out)
    assert (told["parts"], told["ok"], told["kept"], told["failed"]) == (3, 0, 2, 1)
    assert told["failures"][0]["name"] == "missing"
    data = gm.open_dataset("set")
    assert data.manifest()["name"].to_pylist() == ["torus", "sphere", "missing"]
    expected = gm.sample("torus", 50, density="uniform", cells=(8, 8), dtype=np.float32)
    np.testing.assert_array_equal(data.samples(0).points, expected.points)
    assert main(["batch", "torus", *SMALL, "-o", "set", "--overwrite", "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")
    assert len(gm.open_dataset("set")) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "set"], "there are no parts"),
        (["torus"], "missing option '-o' / '--output'"),
        (["torus", "-o", "set", "--fields", "pints"], "points"),
        (["torus", "-o", "set", "--compression", "zip"], "gzip"),
        (["torus", "-o", "set", "--files", "ply"], "'ply'"),
        (["torus", "-o", "set", "--workers", "0"], "whole number"),
        (["torus", "-o", "set", "--time-limit", "-1"], "time_limit"),
        (["torus", "-o", "set", "--count", "5", "--angle", "3"], "not allowed"),
        (["torus", "-o", "list.txt"], "is a file"),
        (["torus", "-o", "."], "new or empty folder"),
        (["--list", "missing.txt", "-o", "set"], "'missing.txt' cannot be read"),
        (["*.step", "-o", "set"], "matches no files"),
        (["folder", "-o", "set"], "has no files of parts"),
    ],
)
def test_bad_use(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("list.txt").write_text("torus")
    Path("folder").mkdir()
    assert main(["batch", *arguments]) == 2
    err = capsys.readouterr().err
    assert err.startswith("gaussmap: error: ")
    assert err.count("\n") == 1
    assert message in err
    assert not Path("set").exists()


def test_lists() -> None:
    for name in ("a/2.STEP", "a/b/1.npz", "a/notes.txt", "a/10.iges", "x[1].step"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).touch()
    assert listed(["a"], None) == ["a/10.iges", "a/2.STEP", "a/b/1.npz"]
    assert listed(["a/*.*s*"], None) == ["a/10.iges"]
    assert listed(["a/**/*.npz", "x[1].step"], None) == ["a/b/1.npz", "x[1].step"]
    Path("list").write_text("torus\n # no\n../../etc/passwd\n", "utf-8")
    assert listed([], "list") == ["torus", "../../etc/passwd"]
    Path("list").write_bytes(b"\xff\xfe")
    with pytest.raises(gm.errors.FileError, match="UTF-8"):
        listed([], "list")
    with pytest.raises(gm.errors.InputError, match="no parts"):
        listed([], None)


@pytest.mark.slow
def test_a_list_on_standard_input_and_files_that_would_lie_elsewhere() -> None:
    grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), axis=-1)
    points = np.concatenate([grid, np.sin(grid[..., :1])], axis=-1)
    np.save("..grid.npy", points)
    done = subprocess.run(
        [sys.executable, "-m", "gaussmap", "batch", "--list", "-", *SMALL[3:], "-o", "inner/set",
         "--files", ".npz"],
        input="..grid.npy\ntorus\n../../../../etc/passwd\n", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 3, done.stderr
    assert sorted(str(x) for x in Path("inner/set/files").iterdir()) == [
        "inner/set/files/000000-grid.npz",
        "inner/set/files/000001-torus.npz",
    ]
