"""A notice on terminals and in notebooks while kernels are compiled at their first call.

Importing this module installs it; `machine_code.jit`, which all kernels need, imports it.
"""

import sys
import time
from contextlib import suppress

from numba.core import event

PACKAGE = __name__.partition(".")[0]
ERASE = "\r\033[K"  # to the start of the line, and clear it
# The package of the standard error of notebooks: not a terminal, but a line in it can be replaced.
NOTEBOOKS = "ipykernel."
# The notice appears after this many seconds of compilation.
PATIENCE = 2.0


class Notice(event.Listener):
    """Shows a line while kernels of gaussmap compile, on standard error unless that is a file.

    The line appears when compilation has taken longer than `PATIENCE` in this process. Numba sends
    events under a lock, so that there is one compilation at a time; each pass of the compiler
    updates the line.
    """

    def __init__(self) -> None:
        self.quiet = False
        self.kernels: list[str] = []  # the kernel, and the kernels nested in it
        self.seconds = 0.0  # seconds spent on earlier kernels
        self.since = 0.0
        self.line = ""

    def on_start(self, event: event.Event) -> None:
        """Record the kernel whose compilation begins; update the line."""
        if event.kind == "numba:compile" and event.data is not None:
            function = event.data["dispatcher"].py_func
            if self.kernels or str(function.__module__).startswith(f"{PACKAGE}."):
                self.kernels.append(function.__name__)
            if len(self.kernels) == 1:
                self.since = time.monotonic()
        if self.kernels:
            self._update()

    def on_end(self, event: event.Event) -> None:
        """Record that a kernel is compiled."""
        if event.kind == "numba:compile" and self.kernels:
            self.kernels.pop()
            if not self.kernels:
                self.seconds += time.monotonic() - self.since
                self._show("")

    def _update(self) -> None:
        seconds = self.seconds + time.monotonic() - self.since
        if seconds > PATIENCE:
            name = self.kernels[0]
            self._show(f"gaussmap: compiling kernels, only once here ({seconds:.0f} s): {name}")

    def _show(self, line: str) -> None:
        """Show `line` in place of the line that is shown now."""
        if line == self.line or self.quiet or sys.stderr is None:
            return
        if sys.stderr.isatty():
            erase = ERASE
        elif type(sys.stderr).__module__.startswith(NOTEBOOKS):
            erase = f"\r{' ' * len(self.line)}\r"
        else:
            return
        self.line = line
        with suppress(OSError, ValueError):  # the terminal is closed
            sys.stderr.write(f"{erase}{line}")
            sys.stderr.flush()


NOTICE = Notice()
for kind in ("numba:compile", "numba:run_pass"):
    event.register(kind, NOTICE)
