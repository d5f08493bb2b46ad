"""A line on terminals for work with an unknown number of steps: its current step, and a clock."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from threading import Event, Thread
from typing import Any

from .compiling import NOTICE
from .threads import seen

# In seconds: the delay before the line appears, and the interval of its updates.
PATIENCE, INTERVAL = 1.0, 0.5


@dataclass
class Step:
    """The current step of a task; `share` returns its finished share, from 0 to 1, if known."""

    task: str
    name: str = ""
    share: Callable[[], float] | None = None

    def __str__(self) -> str:
        parts = [self.task, self.name, "" if self.share is None else f"{self.share():.0%}"]
        return ", ".join(filter(None, parts))


STEP: ContextVar[Step | None] = ContextVar("step", default=None)


def tell(name: str, share: Callable[[], float] | None = None) -> None:
    """Set the current step, if a terminal shows the task; `share` is called during the step."""
    if (step := STEP.get()) is not None:
        step.name, step.share = name, share


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
    done, step = Event(), Step(what)
    before = STEP.set(step)
    thread = Thread(target=_draw, args=(line, step, done), daemon=True)
    thread.start()
    try:
        yield
    finally:
        STEP.reset(before)
        done.set()
        thread.join()
        line.close()


def _draw(line: Any, step: Step, done: Event) -> None:  # noqa: ANN401
    wait = PATIENCE
    while not done.wait(wait):
        wait = INTERVAL
        if not NOTICE.line:  # two lines would overwrite each other
            line.set_description_str(str(step))
    if wait is not PATIENCE:
        line.clear()
