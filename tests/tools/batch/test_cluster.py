"""Runs on a cluster: a scheduler of Dask and two workers on this machine, each a process."""

import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.batch import making
from gaussmap.tools.batch.making import make
from gaussmap.tools.batch.plan import Asked
from gaussmap.tools.batch.running import Tally

pytest.importorskip("pyarrow")
distributed = pytest.importorskip("distributed")
PARTS = 40
STORED = {"fields": ("points", "normals"), "dtype": "float32", "compression": "zstd", "files": None}
LIMITS: dict[str, Any] = {"time_limit": 60.0, "memory_limit": 4.0}
ASKED = Asked({"count": 50, "density": "uniform", "cells": [8, 8]})


def waves(seed: int) -> gm.Surface:
    def position(u, v):
        time.sleep(0.005)
        return np.stack([u, v, np.sin(u + seed) * np.cos(v)], axis=-1)

    return gm.Surface.from_callable(position, ((-1, 1), (-1, 1)), name=f"waves {seed}")


def free_port() -> int:
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return place.getsockname()[1]


def data_of(folder: Path) -> dict[str, Any]:
    manifest = gm.open_dataset(folder).manifest().drop_columns(["seconds", "attempts"])
    points = {x.name: x.read_bytes() for x in sorted((folder / "points").iterdir())}
    return {"points": points, "manifest": manifest.to_pylist()}


class Cluster:
    """A scheduler and workers of one thread each, which can be killed."""

    def __init__(self, folder: Path, workers: int) -> None:
        self.address = f"tcp://127.0.0.1:{free_port()}"
        port = self.address.rpartition(":")[2]
        self.folder = folder
        self.processes = [
            self.start("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard")
        ]
        for _ in range(workers):
            self.add_worker()

    def start(self, kind: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
        return subprocess.Popen(
            command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, cwd=self.folder
        )

    def add_worker(self) -> None:
        self.processes.append(
            self.start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        )

    def end(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "workers").mkdir()
    found = Cluster(tmp_path / "workers", 2)
    yield found
    found.end()


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(tmp_path, cluster, monkeypatch):
    """It is killed when ten parts are done."""
    parts, killed, watched = [waves(k) for k in range(PARTS)], [], making.watched

    def killing(*arguments: Any) -> Iterator[Tally]:
        done = 0
        for tally in watched(*arguments):
            done += tally.parts
            if done >= 10 and not killed:
                killed.append(done)
                cluster.processes[1].kill()
            yield tally

    monkeypatch.setattr(making, "watched", killing)
    how = {"disable": True}
    tally = make(parts, tmp_path / "cluster", ASKED, STORED,
                 workers=None, scheduler=cluster.address, how=how, **LIMITS)  # fmt: skip
    assert killed
    assert (tally.parts, tally.failed) == (PARTS, 0)
    make(parts, tmp_path / "here", ASKED, STORED, workers=2, scheduler=None, how=how, **LIMITS)
    assert data_of(tmp_path / "cluster") == data_of(tmp_path / "here")
    assert not list((tmp_path / "cluster" / "partial").iterdir())


@pytest.mark.slow
def test_the_same_call_with_a_client(tmp_path, cluster):
    with distributed.Client(cluster.address, set_as_default=False) as client:
        data = gm.sample_many(
            ["torus", "sphere", "missing.step"], 50, out=tmp_path / "set", scheduler=client,
            progress=False, density="uniform", cells=(8, 8),
        )  # fmt: skip
        assert data.manifest()["status"].to_pylist() == ["ok", "ok", "failed"]
        assert client.status == "running"


@pytest.mark.slow
def test_a_scheduler_without_workers(tmp_path, monkeypatch):
    monkeypatch.setattr("gaussmap.tools.batch.cluster.PATIENCE", 3)
    found = Cluster(tmp_path, 0)
    try:
        with pytest.raises(gm.errors.FileError, match="has no workers"):
            gm.sample_many(["torus"], 50, out=tmp_path / "set", scheduler=found.address)
    finally:
        found.end()


def test_bad_schedulers(tmp_path, monkeypatch):
    monkeypatch.setattr("gaussmap.tools.batch.cluster.PATIENCE", 1)
    with pytest.raises(gm.errors.InputError, match="address of a scheduler"):
        gm.sample_many(["torus"], 50, out=tmp_path / "set", scheduler=5)
    with pytest.raises(gm.errors.FileError, match="no scheduler of Dask answers"):
        gm.sample_many(
            ["torus"], 50, out=tmp_path / "set", scheduler=f"tcp://127.0.0.1:{free_port()}"
        )
