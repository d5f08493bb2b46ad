"""Saying on a terminal that kernels are being compiled, which makes their first call slow.

Importing this module is enough: modules whose kernels users call import it.
"""

from __future__ import annotations

import sys
import time
from contextlib import suppress

from numba.core import event

__all__ = ["NOTICE", "Notice"]

PACKAGE = __name__.partition(".")[0]
ERASE = "\r\033[K"  # to the start of the line, and clear it
# Seconds of compilation that nobody needs to be told about.
PATIENCE = 2.0


class Notice(event.Listener):
    """Shows a line on standard error, if that is a terminal, while kernels of gaussmap compile.

    The line appears when that has taken longer than `PATIENCE` in this process. Numba sends events
    under a lock, so there is one compilation at a time; its passes serve as a clock.
    """

    def __init__(self) -> None:
        self.quiet = False
        self.kernels: list[str] = []  # a kernel has those compiled that it calls
        self.seconds = 0.0  # spent on earlier kernels
        self.since = 0.0
        self.line = ""

    def on_start(self, event: event.Event) -> None:
        """Note which kernel begins, or that time has passed."""
        if event.kind == "numba:compile" and event.data is not None:
            function = event.data["dispatcher"].py_func
            if self.kernels or str(function.__module__).startswith(f"{PACKAGE}."):
                self.kernels.append(function.__name__)
            if len(self.kernels) == 1:
                self.since = time.monotonic()
        if self.kernels:
            self._tell()

    def on_end(self, event: event.Event) -> None:
        """Note that a kernel is done."""
        if event.kind == "numba:compile" and self.kernels:
            self.kernels.pop()
            if not self.kernels:
                self.seconds += time.monotonic() - self.since
                self._show("")

    def _tell(self) -> None:
        seconds = self.seconds + time.monotonic() - self.since
        if seconds > PATIENCE:
            name = self.kernels[0]
            self._show(f"gaussmap: compiling kernels, only once here ({seconds:.0f} s): {name}")

    def _show(self, line: str) -> None:
        """Replace the line by another one."""
        if line == self.line or self.quiet or sys.stderr is None or not sys.stderr.isatty():
            return
        self.line = line
        with suppress(OSError, ValueError):  # nobody hears it
            sys.stderr.write(f"{ERASE}{line}")
            sys.stderr.flush()


NOTICE = Notice()
for kind in ("numba:compile", "numba:run_pass"):
    event.register(kind, NOTICE)
