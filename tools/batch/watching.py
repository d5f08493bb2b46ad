"""Watching a run: a bar on a terminal, or lines of a log."""

from __future__ import annotations

import sys
from typing import Any

from tqdm import tqdm

from ...runtime.base.threads import seen
from .running import Tally

__all__ = ["Watch", "progress"]

# In seconds: how often a log gets a line.
INTERVAL = 10.0


class Watch:
    """What is told of a run while it goes on, in the process that started it.

    If it is `shown`, a bar on standard error has the parts done, failures, rate and time left.
    `how` are further options of tqdm.
    """

    def __init__(self, shown: bool = False, **how: object) -> None:
        self._how: dict[str, Any] = {"disable": not shown, **how}
        self._failed = 0

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Hear of the number of parts, if it is known, and the address of Dask's dashboard."""
        if dashboard is not None and not self._how["disable"]:
            _Lines().write(f"Dask's dashboard: {dashboard}")
        # The first parts take longer, and those of an earlier run no time: the rate is a mean.
        self._bar = tqdm(total=parts, desc="sampling", unit="part", smoothing=0.1, **self._how)

    def add(self, tally: Tally) -> None:
        """Hear what became of the parts of a shard."""
        self._failed += tally.failed
        if self._failed:
            self._bar.set_postfix(failed=self._failed, refresh=False)
        self._bar.update(tally.parts)

    def end(self) -> None:
        """Hear that the run has ended."""
        self._bar.close()


class _Lines:
    """Standard error as a file of lines."""

    def write(self, text: str) -> None:
        if (line := text.strip()) and sys.stderr is not None:
            print(f"gaussmap: {line}", file=sys.stderr, flush=True)

    def flush(self) -> None:
        pass


def progress() -> Watch:
    """Return what shows a run on standard error: a bar, or a line of a log every ten seconds."""
    if seen(True):
        return Watch(shown=True)
    return Watch(
        shown=True,
        file=_Lines(),
        bar_format="{n} of {total} parts{postfix}, {rate_fmt}, {remaining} left",
        mininterval=INTERVAL,
        miniters=1,
        delay=INTERVAL,
        leave=False,
    )
