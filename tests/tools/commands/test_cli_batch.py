"""The command `gaussmap batch`: lists of parts, what is reported, exit codes."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.commands.cli import main
from gaussmap.tools.commands.part_lists import listed

from ...refusals import refused

SMALL = ["--cells", "8", "8", "--count", "50", "--density", "uniform"]


def test_a_run_and_the_same_again(capfd: pytest.CaptureFixture[str]) -> None:
    Path("list.txt").write_text("# two parts\n\nsphere\nmissing.step\n")
    command = ["batch", "torus", "--list", "list.txt", *SMALL, "-o", "set", "--workers", "1"]
    command += ["--float32"]
    assert main(command) == 3
    out, err = capfd.readouterr()
    assert "set: 100 samples of 3 parts" in out
    assert "missing.step' does not exist" in out
    assert "--retry-failed" in out
    assert "error" not in err  # on a slow machine there is a line on progress
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


def same_as_sample(data: gm.Dataset, part: int, *arguments: str) -> bool:
    """Say whether a part has the points that `gaussmap sample` writes."""
    assert main(["sample", *arguments, *SMALL, "-o", "one.npz", "--quiet"]) == 0
    return np.array_equal(data.samples(part).points, gm.read_samples("one.npz").points)


def test_elevations(capfd: pytest.CaptureFixture[str]) -> None:
    heights = 9 * np.sin(np.add.outer(np.arange(12.0), np.arange(15.0) / 3))
    np.save("heights.npy", heights)
    np.savez("two.npz", high=2 * heights, low=heights)
    command = ["batch", "heights.npy", "two.npz:high", "-o", "set", "--workers", "1", "--quiet"]
    command += SMALL
    assert main([*command, "--spacing", "30", "-30"]) == 0
    data = gm.open_dataset("set")
    assert data.settings.asked["spacing"] == [30.0, -30.0]
    assert data.manifest(["name", "source"]).to_pylist() == [
        {"name": "heights", "source": "heights.npy"},
        {"name": "two:high", "source": "two.npz:high"},
    ]
    assert same_as_sample(data, 0, "heights.npy", "--spacing", "30", "-30")
    assert same_as_sample(data, 1, "two.npz:high", "--spacing", "30", "-30")
    assert main([*command, "--spacing", "30", "30"]) == 2
    assert "spacing [30.0, -30.0], not [30.0, 30.0]" in capfd.readouterr().err


@pytest.mark.slow
def test_formulas() -> None:
    formulas = ["u", "v", "u*v"], ["u", "v", "cos(u)*v"]
    domain = ["--domain", "-1", "1", "-1", "pi/3"]
    command = ["batch", "torus", "--formula", *formulas[0], "--formula", *formulas[1]]
    command += [*domain, *SMALL, "-o", "set", "--workers", "1", "--quiet"]
    assert main(command) == 0
    data = gm.open_dataset("set")
    names = ["torus", "(u, v, u*v)", "(u, v, cos(u)*v)"]
    assert data.manifest()["name"].to_pylist() == names
    assert same_as_sample(data, 0, "torus")
    for part, formula in enumerate(formulas, 1):
        assert same_as_sample(data, part, "--formula", *formula, *domain)


def test_lists() -> None:
    names = ("a/2.STEP", "a/b/1.npz", "a/b/c/3.obj", "a/b/dem.TIF", "a/notes.txt", "a/10.iges")
    for name in (*names, "x[1].step"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).touch()
    assert listed(["a"], None) == ["a/10.iges", "a/2.STEP", "a/b/1.npz", "a/b/dem.TIF"]
    assert listed(["a/*.*s*"], None) == ["a/10.iges"]
    assert listed(["a/**/*.npz", "x[1].step"], None) == ["a/b/1.npz", "x[1].step"]
    assert listed(["a/**/*.i*", "**/*.obj"], None) == ["a/10.iges", "a/b/c/3.obj"]
    Path("list").write_text("torus\n # no\n../../etc/passwd\n", "utf-8")
    assert listed([], "list") == ["torus", "../../etc/passwd"]
    Path("list").write_bytes(b"\xff\xfe")
    refused("UTF-8", listed, [], "list", error=gm.errors.FileError)
    assert listed([], None) == []


@pytest.mark.slow
def test_a_list_on_standard_input() -> None:
    grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), axis=-1)
    points = np.concatenate([grid, np.sin(grid[..., :1])], axis=-1)
    np.save("..grid.npy", points)
    done = subprocess.run(
        [sys.executable, "-m", "gaussmap", "batch", "--list", "-", *SMALL[3:], "-o", "set"],
        input="..grid.npy\ntorus\n../../../../etc/passwd\n", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 3, done.stderr
    rows = gm.open_dataset("set").manifest(("name", "status")).to_pylist()
    assert [(row["name"], row["status"]) for row in rows] == [
        ("..grid", "ok"), ("torus", "ok"), ("passwd", "failed")
    ]  # fmt: skip


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on() -> None:
    command = [sys.executable, "-m", "gaussmap", "batch", *40 * ["torus"], *SMALL, "-o", "set"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not Path("set/points/000000.parquet").exists():
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "gaussmap: what is done is kept: the same command goes on with the rest\n" in err
    assert 1 <= len(gm.open_dataset("set")) < 40
    assert subprocess.run([*command, "--quiet"]).returncode == 0
    assert len(gm.open_dataset("set")) == 40
