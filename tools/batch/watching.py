"""Watching a run: a bar on a terminal, or lines of a log."""

from __future__ import annotations

import sys
import time
from typing import Any

from .making import Watch
from .running import Tally

__all__ = ["Bar", "Log", "progress"]

# In seconds: how often a log gets a line.
INTERVAL = 10.0


def progress() -> Watch:
    """Return what shows a run on standard error."""
    return Bar() if sys.stderr is not None and sys.stderr.isatty() else Log()


class Bar:
    """A bar on standard error, if that is a terminal: parts done, failures, rate and time left."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._failed = 0

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Show an empty bar, and where Dask's dashboard is."""
        from tqdm import tqdm

        # The first parts take longer, and those of an earlier run no time: the rate is a mean.
        self._bar = tqdm(total=parts, desc="sampling", unit="part", disable=None, smoothing=0.1)
        if dashboard is not None and not self._bar.disable:
            self._bar.write(f"Dask's dashboard: {dashboard}", file=sys.stderr)

    def add(self, tally: Tally) -> None:
        """Show that parts are done."""
        self._failed += tally.failed
        if self._failed:
            self._bar.set_postfix(failed=self._failed, refresh=False)
        self._bar.update(tally.parts)

    def end(self, tally: Tally) -> None:
        """End the bar."""
        self._bar.close()


class Log:
    """A line on standard error every ten seconds: parts done, failures, rate and time left."""

    def __init__(self) -> None:
        self._parts: int | None = None
        self._done = Tally()
        self._start = self._last = 0.0

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Say where Dask's dashboard is."""
        self._parts = parts
        self._start = self._last = time.monotonic()
        if dashboard is not None:
            self._say(f"Dask's dashboard: {dashboard}")

    def add(self, tally: Tally) -> None:
        """Say how many parts are done, if the last line is long ago."""
        self._done += tally
        now = time.monotonic()
        if now - self._last >= INTERVAL:
            self._last = now
            self._say(self._line(now - self._start))

    def end(self, tally: Tally) -> None:
        """Say nothing: the summary follows."""

    def _line(self, seconds: float) -> str:
        done, rate = self._done.parts, self._done.parts / seconds
        of = "" if self._parts is None else f" of {self._parts:,}"
        left = "" if self._parts is None else f", {(self._parts - done) / rate:.0f} s left"
        failed = f", {self._done.failed:,} failed" if self._done.failed else ""
        return f"{done:,}{of} parts{failed}, {rate:.1f} parts/s{left}"

    def _say(self, text: str) -> None:
        if sys.stderr is not None:
            print(f"gaussmap: {text}", file=sys.stderr, flush=True)
