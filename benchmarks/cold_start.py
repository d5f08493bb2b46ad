"""What the first call of a process costs with an empty cache of kernels, function by function.

`make cold-start` writes docs/cold_start.md. Each call runs in a process of its own, whose
NUMBA_CACHE_DIR is empty. Times are those of the processor, and of one thread.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numba
from llvmlite.binding import get_host_cpu_name

__all__ = ["CALLS", "cold", "main", "page"]

CALLS = {
    "`gm.sample(torus, normals=…)`": "gm.sample(torus, normals=gm.fibonacci(10_000))",
    "`gm.sample(torus, 10_000)`": "gm.sample(torus, 10_000)",
    "the same, and `.mesh()`": "gm.sample(torus, 10_000).mesh()",
    "`SupportFunction.of_spline(torus)`": (
        "gm.SupportFunction.of_spline(torus).branches(gm.icosphere(8))"
    ),
}
LISTED = 10  # functions in the table of a call

CHILD = """
import json, sys, time
from collections import Counter
from numba.core import event

class Listener(event.Listener):
    def __init__(self):
        self.open, self.seconds, self.calls = [], Counter(), Counter()
    def on_start(self, event):
        if event.data is not None:
            self.open.append([event.data["dispatcher"].py_func, time.process_time(), 0.0])
    def on_end(self, event):
        if event.data is not None:
            function, start, inner = self.open.pop()
            whole = time.process_time() - start
            name = f"{function.__module__}.{function.__qualname__}"
            self.seconds[name] += whole - inner
            self.calls[name] += 1
            if self.open:
                self.open[-1][2] += whole

import gaussmap as gm
torus = gm.surfaces.torus()
listener = Listener()
with event.install_listener("numba:compile", listener):
    CALL
rows = [(name, listener.calls[name], seconds) for name, seconds in listener.seconds.most_common()]
json.dump({"seconds": time.process_time(), "functions": rows}, sys.stdout)
"""

PAGE = """\
# The first call: what compilation costs

Written by `make cold-start`: do not edit. Numba compiles kernels when they are first called, and
keeps the machine code on disk: only the first process pays, and after it the first one that sees
changed kernels, another Numba or another processor. `gaussmap warm` compiles everything ahead.

Seconds of the processor (one core), from the start of Python to the end of the call, in a
process whose cache is empty, and in one that finds all machine code there; and the number of
functions that are compiled, those of Numba's own library included.

| call | empty cache | full cache | functions |
| :-- | --: | --: | --: |
{rows}

The functions that take longest to compile, without those that they call:

{tables}

Measured with Numba {numba} on {processor}.
"""


def cold(call: str, folder: Path) -> dict[str, Any]:
    """Return the seconds of a call in a new process, and the functions it compiled.

    Machine code is read from a folder and written there.
    """
    run = subprocess.run(
        [sys.executable, "-c", CHILD.replace("CALL", call)],
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder), "NUMBA_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        check=True,
    )
    return json.loads(run.stdout)


def page() -> str:
    """Return docs/cold_start.md, measured now."""
    rows, tables = [], []
    for name, call in CALLS.items():
        with tempfile.TemporaryDirectory() as folder:
            first, second = (cold(call, Path(folder)) for _ in range(2))
        functions = first["functions"]
        number = sum(count for _, count, _ in functions)
        rows.append(f"| {name} | {first['seconds']:.1f} | {second['seconds']:.1f} | {number} |")
        lines = [
            f"| `{function.removeprefix('gaussmap.')}` | {count} | {seconds:.2f} |"
            for function, count, seconds in functions[:LISTED]
        ]
        head = f"| {name} | times | seconds |\n| :-- | --: | --: |"
        tables.append("\n".join([head, *lines]))
    return PAGE.format(
        rows="\n".join(rows),
        tables="\n\n".join(tables),
        numba=numba.__version__,
        processor=get_host_cpu_name(),
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the page; return the exit code."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    start = time.monotonic()
    print(page(), end="")
    print(f"cold_start: {time.monotonic() - start:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
