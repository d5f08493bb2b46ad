"""Fail if sampling is slower, relative to the writing limit, than recorded in recorded.json.

`make bench-guard` compares, and `make bench-record` writes the record. A ratio is the time of
writing the same arrays divided by that of sampling or fitting, both in processor time on one
thread, so that other processes disturb it little. Both times are the least of ROUNDS, measured in
turns, since other processes only make times longer. (The largest ratio of a single round would be
that of a round with disturbed writing.) A case fails if its ratio is below SHARE of the recorded
one. Each type of processor has its own record; on a processor without a record nothing is compared.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import process_time

import gaussmap as gm
import numpy as np
from gaussmap.runtime.search.hits import fill_hits
from gaussmap.runtime.search.search import find
from llvmlite.binding import get_host_cpu_name

from .writing import Arrays, Writers, new_arrays

RECORD = Path(__file__).parent / "recorded.json"
ROUNDS = 15
TRIES = 10
RECORDINGS = 5  # the least is recorded, so that a busy machine does not fail
SHARE = 0.7  # of the recorded ratio has to be reached
Work = Callable[[], object]


def _sampling(normals: np.ndarray, cells: int) -> tuple[Work, Arrays]:
    """Return work that finds and fills the samples of a spline of the torus, and their arrays.

    The arrays are reused, as they are for the writing: the cost of new memory varies.
    """
    spline = gm.fit(gm.surfaces.torus(), (cells, cells))
    arrays = new_arrays(len(find(spline, normals, 1)))

    def work() -> None:
        hits = find(spline, normals, 1)
        fill_hits(spline, normals, hits.keys, 0, len(hits), arrays)

    return work, arrays


def _fitting(cells: int) -> tuple[Work, Arrays]:
    """Return gm.fit for a grid, and arrays of as many samples as the grid has points."""
    torus = gm.surfaces.torus()
    lines = [low + (high - low) * np.arange(cells) / cells for low, high in torus.domain]
    values = torus.evaluate(lines[0][:, None], lines[1])
    surface = gm.Surface.from_grid(values, periodic=(True, True))
    return lambda: gm.fit(surface), new_arrays(cells * cells)


# The torus has every normal twice: 4 n² patches share 2 S samples.
CASES: Mapping[str, Callable[[], tuple[Work, Arrays]]] = {
    "icosphere-781-a-patch": lambda: _sampling(gm.icosphere(100), 8),
    "icosphere-5-a-patch": lambda: _sampling(gm.icosphere(100), 100),
    "fibonacci-781-a-patch": lambda: _sampling(gm.fibonacci(100_000), 8),
    "fibonacci-5-a-patch": lambda: _sampling(gm.fibonacci(100_000), 100),
    "fit-grid": lambda: _fitting(256),
}


def quotient(work: Work, limit: Work, rounds: int = ROUNDS) -> float:
    """Return the ratio of the best time of `limit` to that of `work`; 1 is as fast as the limit.

    The limit has an untimed run before each timed one, so that its memory is in the cache.
    """
    own, writing = [], []
    work()
    for _ in range(rounds):
        limit()
        writing.append(_seconds(limit))
        own.append(_seconds(work))
    return min(writing) / min(own)


def compared(
    record: Mapping[str, float], measure: Mapping[str, Callable[[], float]], tries: int = TRIES
) -> list[tuple[str, float, float, bool]]:
    """Return for each case its name, the recorded and the measured ratio, and whether it passes.

    A ratio that does not pass is measured again, up to `tries` times in total. Raises ValueError
    unless the recorded cases are the measured ones.
    """
    if record.keys() != measure.keys():
        differ = ", ".join(sorted(record.keys() ^ measure.keys()))
        raise ValueError(f"the record and the cases differ in {differ}: run `make bench-record`")
    rows = []
    for name, once in measure.items():
        best = 0.0
        for _ in range(tries):
            best = max(best, once())
            if best >= SHARE * record[name]:
                break
        rows.append((name, record[name], best, best >= SHARE * record[name]))
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare with the record of this type of processor, or write it; return 1 if a case fails."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--record", action="store_true", help="write the record")
    write_record = parser.parse_args(arguments).record
    with Writers(threads=1) as write:
        measure = {name: partial(_measured, make, write) for name, make in CASES.items()}
        records = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
        if write_record:
            ratios = {name: recorded(once) for name, once in measure.items()}
            _store(records | {processor(): ratios})
            return 0
        if processor() not in records:
            known = ", ".join(sorted(records))
            print(f"not compared: recorded were {known}, and this is {processor()}")
            return 0
        rows = compared(records[processor()], measure)
    for name, before, now, enough in rows:
        verdict = "ok" if enough else f"FAILED: below {SHARE:.0%} of the record"
        print(f"{name:<24} {now:8.4f} of the writing limit, recorded {before:.4f}: {verdict}")
    return int(not all(enough for *_, enough in rows))


def recorded(once: Callable[[], float]) -> float:
    """Return the least of several measurements, for the record."""
    return round(min(once() for _ in range(RECORDINGS)), 4)


def _measured(make: Callable[[], tuple[Work, Arrays]], write: Writers) -> float:
    work, arrays = make()
    return quotient(work, lambda: write(arrays))


def processor() -> str:
    """Return the type of the processor, by its name in LLVM; ratios depend on it."""
    return str(get_host_cpu_name())


def _store(record: Mapping[str, object]) -> None:
    """Write the record to a temporary file, then rename it."""
    text = json.dumps(record, indent=4) + "\n"
    written = RECORD.with_suffix(".tmp")
    written.write_text(text, encoding="utf-8")
    os.replace(written, RECORD)
    print(text, end="")


def _seconds(work: Work) -> float:
    """Return the processor time of work in seconds."""
    start = process_time()
    result = work()
    taken = process_time() - start
    del result
    return taken


if __name__ == "__main__":
    sys.exit(main())
