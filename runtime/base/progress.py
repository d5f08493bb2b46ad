"""A clock on terminals for work whose number of steps is unknown."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import Any

from .compiling import NOTICE
from .threads import seen

__all__ = ["busy"]

# In seconds: the delay before the line appears, and the interval of its updates.
PATIENCE, INTERVAL = 1.0, 0.5


@contextmanager
def busy(what: str, progress: bool) -> Iterator[None]:
    """With `progress`, show the current task and its duration on a terminal, after one second."""
    if not seen(progress):
        yield
        return
    from tqdm import tqdm

    line = tqdm(
        desc=what, bar_format="{desc}: {elapsed}", delay=PATIENCE, leave=False, disable=None
    )
    done = Event()
    thread = Thread(target=_draw, args=(line, done), daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
        line.close()


def _draw(line: Any, done: Event) -> None:  # noqa: ANN401
    wait = PATIENCE
    while not done.wait(wait):
        wait = INTERVAL
        if not NOTICE.line:  # two lines would overwrite each other
            line.refresh()
    if wait is not PATIENCE:
        line.clear()
