"""What making a data set costs, and what that means for a million parts.

`make batch` writes docs/batch.md. Parts are grids of points in files, as others would bring them.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.tools.batch.data_files import points_schema, points_table
from gaussmap.tools.batch.folder import MANIFEST, POINTS, Settings, create, parts_per_shard
from gaussmap.tools.batch.inputs import in_shards, inputs_of
from gaussmap.tools.batch.manifest import ManifestRow
from gaussmap.tools.batch.shards import Shard
from llvmlite.binding import get_host_cpu_name

__all__ = ["main", "measured", "page"]

PARTS, COUNT, WORKERS, GRID = 512, 2048, 2, 24
TASKS, LISTED, OF_A_SHARD = 2000, 100_000, 256
# What the page works out.
MANY, MACHINES = 1_000_000, 100
ASKED: dict[str, Any] = {
    "count": COUNT, "density": "uniform", "cells": (16, 16), "dtype": "float32",
    "progress": False,
}  # fmt: skip

PAGE = """\
# Data sets: what a million parts cost

Written by `make batch`: do not edit. The [guide](guides/many_parts.md) shows how to use it.

## Measured

Parts are grids of {grid} x {grid} points in .npy files; {count:,} samples of each, in single
precision, at uniform density (other densities take longer, and CAD parts with many faces much
longer). {workers} processes of one thread, kernels compiled, `sample_many(..., out=...)`. The
first two are of shards of {small} parts, so that their files are in these times.

| what | |
| :-- | --: |
| a part, in one process | {part:.1f} ms |
| a part that is there already, when the run is repeated | {kept:.1f} ms |
| a start: until the first process is ready (imports) | {start:.1f} s |
| points of a part in the Parquet files | {points:.1f} kB |
| row of a part in the manifest | {row:.0f} B |
| adding a part to a shard that is not finished | {add:.2f} ms |
| finishing a shard of {shard} parts: two Parquet files | {commit:.0f} ms |
| a shard as a task of Dask: scheduler, without work | {task:.1f} ms |
| naming a part in the list that is sent to workers | {name:.1f} us |
| largest memory of the main process | {memory:.0f} MB |
| largest memory of a process that samples | {child:.0f} MB |

## Worked out: {many:,} parts on {machines} processes

A shard has {shard} parts, so there are {shards:,} shards.

- **Sampling**: {many:,} x {part:.1f} ms / {machines} = {minutes:.1f} min.
- **Scheduler**: a shard is a task. {shards:,} tasks in that time are {tasks:.2f} a second; it can
  do {rate:.0f}. So it is busy for {busy:.2%} of the time. If each part were a task, it could not
  feed more than about {most:,.0f} processes. It knows of two shards for each process at a time.
- **File system**: {gigabytes:.0f} GB, {megabytes:.0f} MB/s for all processes together; {files:,}
  files stay, and {shards:,} are made and removed again. A file for each part would be
  {many:,} files: `files=` makes these only if they are asked for.
- **Writing**: adding and finishing take {writing:.1%} of the time of a process. Shards share no
  file, so that processes do not wait for each other.
- **Manifest**: {manifest:.0f} MB in {shards:,} files. Nobody writes to all of them; a reader opens
  them one after the other.
- **Main process**: spends {names:.0f} s on naming parts, and keeps counts only. A list of a million
  names takes {listed:.0f} MB; parts of a generator are taken one by one, and not kept.
- **Doing it again**: a run that finds everything there takes {again:.1f} min on the same processes,
  as it reads each file to see whether it changed.

**What saturates first** is a file system that writes less than {megabytes:.0f} MB/s: one of 100
MB/s is saturated by about {disk:,.0f} processes. Then fewer `fields` help.
With a faster one it is the processors; about {feeds:,.0f} processes saturate the scheduler.
The manifest saturates nothing.

Measured with Python {python} on {processor}, {cores} cores with a load of {load:.1f}:
if that is more than their number, times are upper bounds. All is on one machine: the times of the
scheduler have no network in them, and the file system is local.
"""


def measured(folder: Path) -> dict[str, float]:
    """Return the figures of the page, in the units that it names."""
    parts = _files(folder)
    gm.sample_many(parts[:WORKERS], **ASKED, out=folder / "warm", workers=WORKERS)
    # Nothing is left to do in the second run.
    start = _seconds(
        lambda: gm.sample_many(parts[:2], **ASKED, out=folder / "warm", workers=WORKERS)
    )
    seconds = _seconds(lambda: gm.sample_many(parts, **ASKED, out=folder / "all", workers=WORKERS))
    again = _seconds(lambda: gm.sample_many(parts, **ASKED, out=folder / "all", workers=WORKERS))
    figures = {
        "part": (seconds - start) * WORKERS / PARTS * 1e3,
        "kept": max(again - start, 0.0) * WORKERS / PARTS * 1e3,
        "start": start,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
        "child": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3,
    }
    size = sum(x.stat().st_size for x in (folder / "all" / POINTS).iterdir())
    figures |= {"points": size / PARTS / 1e3} | _of_a_shard(folder / "all", folder / "shard")
    names = inputs_of(f"parts/{part}.npy" for part in range(LISTED))
    figures["name"] = _seconds(lambda: list(map(len, in_shards(names, OF_A_SHARD)))) / LISTED * 1e6
    return figures | {"task": _task()}


def _files(folder: Path) -> list[Path]:
    """Write graphs of random waves."""
    rng = np.random.default_rng(0)
    u, v = np.meshgrid(*(np.linspace(-1, 1, GRID),) * 2, indexing="ij")
    paths = [folder / f"{part}.npy" for part in range(PARTS)]
    for path in paths:
        a, b, phase = rng.uniform(-3, 3, 3)
        np.save(path, np.stack([u, v, 0.2 * np.sin(a * u + b * v + phase)], axis=-1))
    return paths


def _seconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def _of_a_shard(known: Path, folder: Path) -> dict[str, float]:
    """Return what a full shard costs, of the parts of another data set."""
    dataset = gm.open_dataset(known)
    settings = Settings.of_this_version(
        {}, dataset.fields, dtype="float32", parts_per_shard=OF_A_SHARD
    )
    create(folder, settings)
    schema = points_schema(settings)
    shard = Shard(folder, 0, settings)
    parts = range(OF_A_SHARD)
    tables = [points_table(dataset.samples(part), part, schema) for part in parts]
    known_rows = dataset.manifest().to_pylist()
    rows = [ManifestRow(**known_rows[part]) for part in parts]
    add = _seconds(lambda: [*map(shard.add, rows, tables)])
    commit = _seconds(lambda: shard.commit(parts))
    size = sum(x.stat().st_size for x in (folder / MANIFEST).iterdir())
    return {
        "add": add / OF_A_SHARD * 1e3,
        "commit": commit * 1e3,
        "row": size / OF_A_SHARD,
    }


def _task() -> float:
    """Return the milliseconds that Dask takes for a task that does nothing."""
    import distributed

    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0"
        ) as some,
        distributed.Client(some) as client,
    ):
        client.gather(client.map(float, range(100)))
        return _seconds(lambda: client.gather(client.map(int, range(TASKS)))) / TASKS * 1e3


def page(figures: dict[str, float]) -> str:
    """Return docs/batch.md: the figures, and what follows."""
    part, commit, add, task = (figures[x] / 1e3 for x in ("part", "commit", "add", "task"))
    shards = -(-MANY // OF_A_SHARD)
    seconds = MANY * part / MACHINES
    bytes_a_second = figures["points"] * 1e3 * MANY / seconds
    busy = shards * task / seconds
    return PAGE.format(
        **figures,
        grid=GRID, count=COUNT, workers=WORKERS, shard=OF_A_SHARD,
        many=MANY, machines=MACHINES, shards=shards, files=2 * shards,
        minutes=seconds / 60, tasks=shards / seconds, rate=1 / task, busy=busy, most=part / task,
        gigabytes=figures["points"] * MANY / 1e6, megabytes=bytes_a_second / 1e6,
        writing=(add + commit / OF_A_SHARD) / part,
        manifest=figures["row"] * MANY / 1e6, names=figures["name"] * MANY / 1e6,
        again=figures["kept"] / 1e3 * MANY / MACHINES / 60,
        disk=MACHINES * 1e8 / bytes_a_second, feeds=MACHINES / busy,
        small=parts_per_shard(PARTS, COUNT), listed=MANY * (sys.getsizeof("p" * 40) + 8) / 1e6,
        cores=os.cpu_count(), load=os.getloadavg()[0],
        python=sys.version.split()[0], processor=get_host_cpu_name(),
    )  # fmt: skip


def main() -> None:
    """Print the page."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    with tempfile.TemporaryDirectory() as name:
        print(page(measured(Path(name))), end="")


if __name__ == "__main__":
    main()
