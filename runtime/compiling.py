"""Saying that kernels are being compiled: the first run ever takes some seconds longer."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from numba.core import event

__all__ = ["compilation_shown"]

ERASE = "\r\033[K"  # to the start of the line, and clear it


class _Notice(event.Listener):
    """Shows on a terminal which kernel is being compiled, until that is done."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.depth = 0  # a kernel has those compiled that it calls; Numba does it under a lock

    def on_start(self, event: event.Event) -> None:
        if self.depth == 0 and event.data is not None:
            name = event.data["dispatcher"].py_func.__name__
            self._write(f"{ERASE}compiling {name} (the first time only)")
        self.depth += 1

    def on_end(self, event: event.Event) -> None:
        self.depth -= 1
        if self.depth == 0:
            self._write(ERASE)

    def _write(self, text: str) -> None:
        self.stream.write(text)
        self.stream.flush()


@contextmanager
def compilation_shown(progress: bool) -> Iterator[None]:
    """With `progress`, show on standard error, if that is a terminal, what is being compiled."""
    if not progress or sys.stderr is None or not sys.stderr.isatty():
        yield
        return
    with event.install_listener("numba:compile", _Notice(sys.stderr)):
        yield
