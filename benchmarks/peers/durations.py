"""How long sampling takes: the first table of docs/performance.md."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gaussmap.docs.markdown import markdown, wrapped

from .forms import FORMS
from .recipe import by_grid

COUNTS = (10**4, 10**6, 10**8)
STREAMED = 10**7
FIRST = COUNTS[0]
AT_NORMALS, DEFAULT, STREAM = "at normals", "default", "stream"
# For a number of samples N; the torus has every normal twice.
CALLS = {
    AT_NORMALS: "gm.sample(torus, normals=gm.fibonacci(N // 2))",
    STREAM: "sum(len(x) for x in gm.sample_stream(torus, normals=gm.fibonacci(N // 2)))",
    DEFAULT: "gm.sample(torus, N)",
}
CHILD = """
import json, time
start = time.perf_counter()
import gaussmap as gm
N = COUNT
torus = gm.surfaces.torus()
times = []
for k in range(REPEATED):
    CALL
    times.append(time.perf_counter() - start)
    start = time.perf_counter()
print(json.dumps(times))
"""

WORDS = """\
## How long it takes

Seconds of wall time for points of a torus with normals, parameters and curvatures, on all cores,
the fit of the spline included; more than {stream:,} points come in chunks (`gm.sample_stream`).

{table}

For its first 10⁴ points, a new process takes {warm}, imports and loading of machine code included
([details](install.md#compiled-kernels)).

If there is a closed form, a grid of parameters is faster: {ratio} times as fast as points at
normals, for {largest:,} points. Use gaussmap for what a grid of parameters does not have: the
points that have given normals, each exactly once; density that follows curvature, and guarantees
for gaps and angles; surfaces without a closed form (functions, data, NURBS, CAD files); offsets,
silhouettes and meshes of the same samples.

"""


@dataclass(frozen=True)
class Duration:
    """Seconds by numbers of samples: at normals, by default, and of a grid in NumPy.

    `warm` are the seconds of the first samples in a new process: at normals, and by default.
    """

    at_normals: dict[int, float]
    default: dict[int, float]
    grid: dict[int, float]
    warm: tuple[float, float]


def measure_durations(largest: int) -> Duration:
    """Measure all durations, for numbers of samples up to `largest`."""
    counts = [x for x in COUNTS if x <= max(largest, FIRST)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        new = {kind: _seconds(kind, FIRST, folder, 9) for kind in (AT_NORMALS, DEFAULT)}
        at_normals, default = ({FIRST: min(new[kind][1:])} for kind in (AT_NORMALS, DEFAULT))
        for count in counts[1:]:
            kind = STREAM if count > STREAMED else AT_NORMALS
            at_normals[count] = min(_seconds(kind, count, folder, 3 if count < STREAMED else 1))
            if count <= STREAMED:
                default[count] = min(_seconds(DEFAULT, count, folder, 2))
    grid = {count: _of_grid(count) for count in counts if count <= STREAMED}
    return Duration(at_normals, default, grid, (new[AT_NORMALS][0], new[DEFAULT][0]))


def durations(measured: Duration) -> str:
    """Return the section of the page."""
    columns = measured.at_normals, measured.default, measured.grid
    rows = [
        [f"{count:,}", *(_text(column[count]) if count in column else "–" for column in columns)]
        for count in measured.at_normals
    ]
    header = ["points", "at normals", "default, `balanced`", "NumPy grid, closed form"]
    largest = max(measured.grid)
    words = WORDS.format(
        stream=STREAMED,
        table="TABLE",
        warm=f"{measured.warm[0]:.1f} s at given normals and {measured.warm[1]:.1f} s by default",
        ratio=f"{measured.at_normals[largest] / measured.grid[largest]:.1f}",
        largest=largest,
    )
    return wrapped(words).replace("TABLE\n", markdown(header, rows))


def _seconds(kind: str, count: int, folder: Path, repeated: int) -> Sequence[float]:
    """Return the times of calls in a new process, whose machine code is in a folder."""
    text = CHILD.replace("COUNT", str(count)).replace("REPEATED", str(repeated))
    run = subprocess.run(
        [sys.executable, "-c", text.replace("CALL", CALLS[kind])],
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder)},
        stdout=subprocess.PIPE,
        check=True,
    )
    return json.loads(run.stdout)


def _of_grid(count: int) -> float:
    from time import perf_counter

    times = []
    for _ in range(5):
        start = perf_counter()
        by_grid(FORMS[0], count)
        times.append(perf_counter() - start)
    return min(times)


def _text(seconds: float) -> str:
    return f"{seconds:.2g}" if seconds < 10.0 else f"{seconds:.0f}"
