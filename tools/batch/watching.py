"""Watching a run: a bar on a terminal, or lines of a log."""

from __future__ import annotations

import sys
from typing import Any

from tqdm import tqdm

from ...runtime.base.threads import seen
from .running import Tally

__all__ = ["Bar", "Log", "Watch", "progress"]

# In seconds: how often a log gets a line.
INTERVAL = 10.0


class Watch:
    """What is told of a run while it goes on, in the process that started it; this says nothing."""

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Hear of the number of parts, if it is known, and the address of Dask's dashboard."""

    def add(self, tally: Tally) -> None:
        """Hear what became of the parts of a shard."""

    def end(self) -> None:
        """Hear that the run has ended."""


class Bar(Watch):
    """A bar on standard error, if that is a terminal: parts done, failures, rate and time left."""

    how: dict[str, Any] = {"disable": None}  # noqa: RUF012 - no other object changes it

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Show an empty bar, and where Dask's dashboard is."""
        if dashboard is not None:
            self._say(f"Dask's dashboard: {dashboard}")
        # The first parts take longer, and those of an earlier run no time: the rate is a mean.
        self._bar = tqdm(total=parts, desc="sampling", unit="part", smoothing=0.1, **self.how)
        self._failed = 0

    def add(self, tally: Tally) -> None:
        """Show that parts are done."""
        self._failed += tally.failed
        if self._failed:
            self._bar.set_postfix(failed=self._failed, refresh=False)
        self._bar.update(tally.parts)

    def end(self) -> None:
        """End the bar."""
        self._bar.close()

    def _say(self, text: str) -> None:
        if seen(True):
            print(text, file=sys.stderr)


class Log(Bar):
    """The same as a line every ten seconds."""

    def __init__(self) -> None:
        """Write lines in place of a bar."""
        self.how = {
            "file": _Lines(),
            "bar_format": "{n} of {total} parts{postfix}, {rate_fmt}, {remaining} left",
            "mininterval": INTERVAL,
            "miniters": 1,
            "delay": INTERVAL,
            "leave": False,
        }

    def _say(self, text: str) -> None:
        _Lines().write(text)


class _Lines:
    """Standard error as a file of lines."""

    def write(self, text: str) -> None:
        if (line := text.strip()) and sys.stderr is not None:
            print(f"gaussmap: {line}", file=sys.stderr, flush=True)

    def flush(self) -> None:
        pass


def progress() -> Watch:
    """Return what shows a run on standard error."""
    return Bar() if seen(True) else Log()
