"""Runs on a cluster: a scheduler of Dask and two workers on this machine, each a process."""

import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.tools.batch import making
from gaussmap.tools.batch.workers import Tally

from ...refusals import refused
from .made import data_of, wait_until, waves

distributed = pytest.importorskip("distributed")
PARTS = 40
HOW: dict[str, Any] = {
    "density": "uniform", "cells": (8, 8), "dtype": "float32", "progress": False,
    "time_limit": 60.0, "memory_limit": 4.0,
}  # fmt: skip


def free_port() -> int:
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return place.getsockname()[1]


class Cluster:
    """A scheduler and workers of one thread each, which can be killed; of each kind one."""

    def __init__(self, folder: Path, workers: Sequence[str]) -> None:
        self.address = f"tcp://127.0.0.1:{free_port()}"
        port = self.address.rpartition(":")[2]
        self.folder = folder
        self.processes = [
            self.start("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard")
        ]
        for nanny in workers:
            self.processes.append(
                self.start("worker", self.address, "--nthreads", "1", nanny, "--no-dashboard")
            )

    def start(self, kind: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
        return subprocess.Popen(
            command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, cwd=self.folder
        )

    def end(self) -> None:
        for process in self.processes:
            process.terminate()  # with which a nanny ends its worker
            process.wait()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "workers").mkdir()
    found = Cluster(tmp_path / "workers", ("--no-nanny", "--nanny"))
    yield found
    found.end()


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(tmp_path, cluster, monkeypatch):
    """It is killed when ten parts are done."""
    parts, killed, watched = [waves(k, 0.005) for k in range(PARTS)], [], making.watched

    def killing(*arguments: Any) -> Iterator[Tally]:
        done = 0
        for tally in watched(*arguments):
            done += tally.parts
            if done >= 10 and not killed:
                killed.append(done)
                cluster.processes[1].kill()
            yield tally

    monkeypatch.setattr(making, "watched", killing)
    data = gm.sample_many(parts, 50, out=tmp_path / "cluster", scheduler=cluster.address, **HOW)
    assert killed
    assert data.summary() == f"{PARTS} parts with {50 * PARTS:,} samples"
    gm.sample_many(parts, 50, out=tmp_path / "here", workers=2, **HOW)
    assert data_of(tmp_path / "cluster") == data_of(tmp_path / "here")


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
    found = Cluster(tmp_path, ())
    place = "127.0.0.1", int(found.address.rpartition(":")[2])
    try:
        with socket.socket() as own:
            wait_until(lambda: own.connect_ex(place) == 0)  # the scheduler answers
        refused_by("has no workers", tmp_path, found.address)
    finally:
        found.end()


def refused_by(said: str, folder: Path, scheduler: Any, error: Any = gm.errors.FileError) -> None:
    how: dict[str, Any] = {"out": folder / "set", "scheduler": scheduler}
    refused(said, gm.sample_many, ["torus"], 50, **how, error=error)


def test_bad_schedulers(tmp_path, monkeypatch):
    monkeypatch.setattr("gaussmap.tools.batch.cluster.PATIENCE", 1)
    refused_by("address of a scheduler", tmp_path, 5, gm.errors.InputError)
    refused_by("no scheduler of Dask answers", tmp_path, f"tcp://127.0.0.1:{free_port()}")
