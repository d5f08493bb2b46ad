"""Ratios, not seconds: benchmarks are timed in turns with the work to which they are compared.

The machine's speed drifts; a ratio of two times that were taken right after each other does not.
`compare` keeps the median of the ratios of all rounds. A table of these ratios is printed at the
end of the run, and they are in `extra_info` of the JSON report.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import pytest

Work = Callable[[], object]


@dataclass(frozen=True)
class Row:
    """One line of the table: a benchmark, its median time, its rate, its ratios in words."""

    name: str
    seconds: float
    rate: str
    ratios: str


ROWS = pytest.StashKey[list[Row]]()


@dataclass(frozen=True)
class Compare:
    """Times work in turns with others; see the fixture `compare`."""

    benchmark: Any
    rows: list[Row]

    def __call__(
        self,
        work: Work,
        *,
        limits: Mapping[str, Work] | None = None,
        baselines: Mapping[str, Work] | None = None,
        units: Mapping[str, int] | None = None,
        rounds: int = 5,
        warm: bool = True,
        **extra_info: float,
    ) -> None:
        """Time `work` in `rounds`; before each, time every one of `limits` and `baselines`.

        A limit is the best that the machine can do: `of_<name>` is the share of its speed that is
        reached. It gets an untimed run before each timed one, which `work` does not get. A baseline
        is work that users know: `times_<name>` is the time of `work` divided by its time. `units`
        are the amounts of work in one round: {"samples": 1000} gives `samples_per_second`. With
        `warm`, everything runs once before it is timed.
        """
        others = {**(limits or {}), **(baselines or {})}
        own: list[float] = []
        times: dict[str, list[float]] = {name: [] for name in others}
        kept: list[object] = []  # outputs are freed between the rounds, not inside them

        def before() -> None:
            kept.clear()
            for name, other in others.items():
                if name in (limits or {}):
                    other()
                times[name].append(_seconds(other))

        def timed() -> None:
            start = perf_counter()
            kept.append(work())
            own.append(perf_counter() - start)

        if warm:
            for other in others.values():
                other()
            work()
        self.benchmark.pedantic(timed, setup=before, rounds=rounds)

        seconds = median(own)
        info: dict[str, float] = dict(extra_info)
        for unit, amount in (units or {}).items():
            info[f"{unit}_per_second"] = amount / seconds
        words = []
        for name, taken in times.items():
            pairs = zip(taken, own, strict=True)
            if name in (limits or {}):
                info[f"of_{name}"] = share = median(other / mine for other, mine in pairs)
                words.append(f"{100.0 * share:.3g} % of {name.replace('_', ' ')}")
            else:
                info[f"times_{name}"] = factor = median(mine / other for other, mine in pairs)
                words.append(f"{factor:.3g} x {name.replace('_', ' ')}")
        self.benchmark.extra_info.update(info)
        rates = [f"{info[f'{unit}_per_second']:.3g} {unit}/s" for unit in units or {}]
        name = self.benchmark.name.removeprefix("test_")
        self.rows.append(Row(name, seconds, ", ".join(rates), ", ".join(words)))


def _seconds(work: Work) -> float:
    start = perf_counter()
    result = work()
    taken = perf_counter() - start
    del result
    return taken


@pytest.fixture
def compare(benchmark: Any, request: pytest.FixtureRequest) -> Compare:
    """Time work in turns with limits and baselines: see `Compare.__call__`."""
    return Compare(benchmark, request.config.stash[ROWS])


@pytest.fixture
def run(tmp_path: Any) -> Callable[..., Work]:
    """Make work that runs this Python with arguments, or a script in its folder, in a new process.

    run("-c", "import numpy") runs Python; run("surfaces", script="gaussmap") runs the console
    script. `cache` is the folder of Numba's machine code.
    """

    def make(*arguments: str, script: str | None = None, cache: Any = None) -> Work:
        python = Path(sys.executable)
        program = python.with_name(script) if script else python
        environment = os.environ | ({"NUMBA_CACHE_DIR": str(cache)} if cache else {})
        environment.pop(
            "PYTHONDONTWRITEBYTECODE", None
        )  # the cache of Python's byte code is warm as well
        return partial(
            subprocess.run,
            [str(program), *arguments],
            cwd=tmp_path,
            env=environment,
            check=True,
            stdout=subprocess.DEVNULL,
        )

    return make


@pytest.fixture(scope="session")
def warm_cache(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return a folder for Numba's machine code that lasts as long as the session."""
    return tmp_path_factory.mktemp("numba")


def pytest_configure(config: pytest.Config) -> None:
    config.stash[ROWS] = []


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    rows = config.stash[ROWS]
    if not rows:
        return
    terminalreporter.section("medians, and ratios to what was timed in turns with it")
    cells = [(row.name, f"{1e3 * row.seconds:,.1f} ms", row.rate, row.ratios) for row in rows]
    widths = [max(len(line[k]) for line in cells) for k in range(3)]
    for name, time, rate, ratios in cells:
        line = f"{name:<{widths[0]}}  {time:>{widths[1]}}  {rate:<{widths[2]}}  {ratios}"
        terminalreporter.write_line(line.rstrip())
    if hasattr(os, "getloadavg"):
        load = os.getloadavg()[1]
        terminalreporter.write_line(f"load of the last five minutes: {load:.1f}")
