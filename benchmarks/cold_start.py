"""The cost of the first call of a process: with the kernels of the package, and without.

CI runs `python cold_start.py --check` in an environment with a wheel: no usual call, and with --all
no call at all, may compile a kernel, or take more than MOST seconds longer than its repetition.
`make kernels` lists the kernels that `--usual` compiles. Each call runs in its own process, whose
NUMBA_CACHE_DIR is empty (with `--usual`, it is the given folder). This file imports only the
standard library, so that it runs in that environment.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

# The largest number of seconds of processor time that a first call may take beyond its repetition;
# the same for a call that imports SymPy and computes derivatives.
MOST, MOST_OF_SYMPY = 1.5, 3.0
TORUS = "gm.sample('torus', 10_000{})"
WAVES = "np.hypot(*np.mgrid[-1:1:40j, -1:1:50j])**3"
NET = "np.stack([*np.mgrid[0:4.0, 0:4.0], np.cos(np.mgrid[0:4.0, 0:4.0]).sum(axis=0)], axis=-1)"
CALLS = {
    "`gm.sample(torus, 10_000)`": TORUS.format(""),
    "the same, and `.mesh()`": TORUS.format("") + ".mesh()",
    "the same, and `.coverage()`": TORUS.format("") + ".coverage()",
    "… `normals=…`": "gm.sample('torus', normals=gm.fibonacci(10_000))",
    "`gm.GaussMap(torus).points(…)`": "gm.GaussMap('torus').points(gm.fibonacci(10_000))",
    "… `angle=3`": "gm.sample('torus', angle=3)",
    "… `coverage=0.05`": "gm.sample('torus', coverage=0.05)",
    '… `density="gauss"`': TORUS.format(", density='gauss'"),
    '… `density="aligned"`': TORUS.format(", density='aligned'"),
    '… `density="uniform"`': TORUS.format(", density='uniform'"),
    "… `dtype=float32`": TORUS.format(", dtype=np.float32"),
    "`SupportFunction.of_spline(torus)`": (
        "gm.SupportFunction.of_spline(gm.surfaces.torus()).branches(gm.icosphere(8))"
    ),
    "`gm.silhouette(torus)`": "gm.silhouette(gm.surfaces.torus(), direction=(1, 2, 3))",
    "`Surface.from_callable`": (
        "gm.sample(gm.Surface.from_callable("
        "lambda u, v: np.stack([u, v, np.sin(3*u)*v], -1), ((0, 1), (0, 1))), 1000)"
    ),
    "`Surface.from_grid`": f"gm.sample(gm.Surface.from_grid({WAVES}, spacing=(1.0, 1.0)), 1000)",
    "`Surface.from_nurbs`": (
        f"gm.sample(gm.Surface.from_nurbs((3, 3), (np.repeat([0.0, 1.0], 4),)*2, {NET}), 1000)"
    ),
    "`Surface.from_sympy`": (
        "gm.sample(gm.Surface.from_sympy(('u', 'v', 'u**2*v + sin(v)'), ('u', 'v'), "
        "domain=((-1, 1), (-1, 1))), 1000)"
    ),
    "`SupportFunction.from_sympy`": (
        "gm.SupportFunction.from_sympy('sqrt(4*n_x**2 + n_y**2 + n_z**2)')"
        ".branches(gm.fibonacci(1000))"
    ),
    "all surfaces of the catalogue": "[gm.sample(x, 100) for x in gm.surfaces.names()]",
    "a part from an .npz file": "gm.sample(gm.read_part('part.npz'), 2000)",
}
# The following calls start other processes, or are the command line: they are not repeated.
BATCH = """
import gaussmap as gm
if __name__ == "__main__":
    done = gm.sample_many(["part.npz"] * 20, 200, out="data", workers=2, progress=False)
    assert len(done) == 20
"""
GAUSSMAP = ["-m", "gaussmap"]
COMMANDS = {
    "20 parts by two processes": ["-c", BATCH],
    "`gaussmap sample`": [*GAUSSMAP, "sample", "torus", "--count", "10000", "-o", "torus.ply"],
    "`gaussmap mesh`": [*GAUSSMAP, "mesh", "torus", "--count", "2000", "-o", "torus.stl"],
}
PLOT = "`gaussmap plot`"
if find_spec("matplotlib") is not None:
    COMMANDS[PLOT] = [*GAUSSMAP, "plot", "torus", "-o", "torus.png"]
# An installation compiles the kernels of these calls beforehand (`usual.json`).
USUAL = (
    *list(CALLS)[:5],
    '… `density="gauss"`',
    "`Surface.from_callable`",
    "`Surface.from_grid`",
    "all surfaces of the catalogue",
    *(x for x in COMMANDS if x.startswith("`gaussmap")),
)
CHILD = """
import json, sys, time, warnings
import numpy as np
import gaussmap as gm
times = [time.process_time()]
for _ in range(2):
    CALL
    times.append(time.process_time())
json.dump(times, sys.stdout)
"""
# A part with faces of all kinds, for the calls that read one.
PART = "from gaussmap.tools.cad.examples import all_kinds; all_kinds().save('part.npz')"
HERE_ONLY = {"GAUSSMAP_KERNELS": "0"}


class Cost(NamedTuple):
    """The cost of a process in seconds of processor time, and in compiled kernels."""

    seconds: float
    """From the start of Python to the end of the first call, or of a process without repetition."""
    beyond: float
    """The seconds of the first call beyond those of its repetition; 0 without a repetition."""
    compiled: int
    """The number of kernels in the folder of the cache afterwards."""


def cost(arguments: Sequence[str], cache: Path, options: Mapping[str, str] | None = None) -> Cost:
    """Run Python with arguments, in the parent folder of the cache; return the cost."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), **(options or {})}
    before = _of_children()
    run = subprocess.run(
        [sys.executable, *arguments],
        env=environment,
        cwd=cache.parent,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    seconds, beyond = _of_children() - before, 0.0
    if run.stdout.startswith("["):
        start, first, second = json.loads(run.stdout)
        seconds, beyond = first, (first - start) - (second - first)
    return Cost(seconds, beyond, len([*cache.rglob("*.kernel")]))


def _of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def programs() -> dict[str, list[str]]:
    """Return the arguments of Python for each call."""
    calls = {name: ["-c", CHILD.replace("CALL", call)] for name, call in CALLS.items()}
    return calls | COMMANDS


def check(names: Iterable[str]) -> int:
    """Return the number of the named calls that fail; print the cost of each.

    A call fails if it compiles kernels or costs too much.
    """
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        cost(["-c", PART], Path(folder, "cache"))
        for number, name in enumerate(names):
            arguments = programs()[name]
            most = MOST_OF_SYMPY if "sympy" in name else MOST
            each = cost(arguments, Path(folder, f"cache{number}"))
            if each.beyond > most:  # the first run may have compiled modules to byte code
                each = cost(arguments, Path(folder, f"cache{number}"))
            is_right = each.compiled == 0 and each.beyond <= most
            failed += not is_right
            print(
                f"{'ok    ' if is_right else 'FAILED'} {name}: {each.seconds:.2f} s, "
                f"{each.beyond:.2f} beyond its repetition, {each.compiled} kernels compiled"
            )
    return failed


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the costs of first calls; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="fail if a usual call compiles")
    parser.add_argument("--all", action="store_true", help="not only usual calls")
    parser.add_argument("--usual", metavar="FOLDER", type=Path, help="keep there what is compiled")
    options = parser.parse_args(arguments)
    if options.usual is not None:
        for name in USUAL:
            cost(programs()[name], options.usual.resolve(), HERE_ONLY)
        return 0
    return 1 if check(programs() if options.all else USUAL) and options.check else 0


if __name__ == "__main__":
    sys.exit(main())
