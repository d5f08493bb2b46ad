"""Watching a run: a bar on a terminal."""

from __future__ import annotations

from typing import Any

from .running import Tally

__all__ = ["Bar"]


class Bar:
    """A bar on standard error, if that is a terminal: parts done, failures, rate and time left."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._failed = 0

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Show an empty bar, and where Dask's dashboard is."""
        from tqdm import tqdm

        self._bar = tqdm(total=parts, desc="sampling", unit="part", disable=None)
        if dashboard is not None and not self._bar.disable:
            self._bar.write(f"Dask's dashboard: {dashboard}")

    def add(self, tally: Tally) -> None:
        """Show that parts are done."""
        self._failed += tally.failed
        if self._failed:
            self._bar.set_postfix(failed=self._failed, refresh=False)
        self._bar.update(tally.parts)

    def end(self, tally: Tally) -> None:
        """End the bar."""
        self._bar.close()
