"""Temporary files of processes that were killed are removed, and no others."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from gaussmap.tools.files import temporary
from gaussmap.tools.files.paths import atomic_path

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc")

PROGRAM = """
import os, sys, signal
from gaussmap.tools.files.paths import atomic_path
with atomic_path(sys.argv[1]) as path:
    path.write_text("half")
    print(path, flush=True)
    if sys.argv[2] == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    sys.stdin.read()
"""


def written(folder: Path, how: str) -> tuple[Path, subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(folder / "a.txt"), how],
        stdout=subprocess.PIPE, stdin=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    return Path(process.stdout.readline().strip()), process


def test_of_the_dead_and_of_the_living(tmp_path):
    dead, killed = written(tmp_path, "die")
    killed.communicate()
    assert killed.returncode == -signal.SIGKILL
    assert dead.exists()
    alive, other = written(tmp_path, "wait")  # which removes the first one
    assert not dead.exists()
    with atomic_path(tmp_path / "b.txt") as path:
        assert alive.exists()
        path.write_text("b")
    other.communicate("")
    assert sorted(x.name for x in tmp_path.iterdir()) == ["a.txt", "b.txt"]


def test_what_is_left_alone(tmp_path):
    machine = temporary.this_machine()
    parent, began = os.getppid(), temporary.began_at(os.getppid())
    kept = [
        "gaussmap-notes", ".gaussmap-0123456789abcdef.json", f".gaussmap-{machine}-x-1-0.ply",
        ".gaussmap-0123456789ab-1-1-00.ply", f".gaussmap-{machine}-{parent}-{began}-00.ply",
        "a-b-c-d",
    ]  # fmt: skip
    gone = [f".gaussmap-{machine}-{parent}-1-00.ply", f"gaussmap-{machine}-99999999-7-00.xyz"]
    for name in kept + gone:
        (tmp_path / name).touch()
    folder = tmp_path / f"gaussmap-{machine}-99999999-7-01.abc"
    folder.mkdir()
    (folder / "part.npz").touch()
    temporary.remove_left(tmp_path)
    assert sorted(x.name for x in tmp_path.iterdir()) == sorted(kept)
    temporary.remove_left(tmp_path / "missing")


def test_without_knowledge_of_processes(tmp_path, monkeypatch):
    name = f".{temporary.new_name()}.ply"
    monkeypatch.setattr(temporary, "PROCESSES", tmp_path / "none")
    temporary.this_machine.cache_clear()
    try:
        (tmp_path / name).touch()
        temporary.remove_left(tmp_path)
        assert (tmp_path / name).exists()
        assert temporary.new_name().startswith("gaussmap-x-")
    finally:
        temporary.this_machine.cache_clear()
