"""`gaussmap warm`: ahead-of-time compilation of all listed kernels, without running them."""

from __future__ import annotations

import time
from types import SimpleNamespace

from numba.core import config, event

from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import FileError, InputError
from ...runtime.base.wording import plural
from ...runtime.machine_code import signatures
from ...runtime.machine_code.building import kernel_named
from ...runtime.machine_code.disk import kept_folder
from .console import say

__all__ = ["run"]


class _Counter(event.Listener):
    """Counts compiled kernels, but not the functions that they call."""

    def __init__(self) -> None:
        self.depth = self.count = 0

    def on_start(self, event: event.Event) -> None:
        self.count += self.depth == 0
        self.depth += 1

    def on_end(self, event: event.Event) -> None:
        self.depth -= 1


def run(options: SimpleNamespace) -> None:
    """Compile all kernels that neither the package nor an earlier run has compiled.

    Raises InputError if NUMBA_DISABLE_JIT is set, FileError if there is no writable folder.
    """
    if config.DISABLE_JIT:  # pyright: ignore[reportAttributeAccessIssue]
        raise InputError("NUMBA_DISABLE_JIT is set: nothing is compiled; unset it.")
    folder = kept_folder()
    if folder is None:
        raise FileError(
            "no folder for compiled kernels can be written; set NUMBA_CACHE_DIR to one that can."
        )
    NOTICE.quiet = options.quiet
    counter, start = _Counter(), time.monotonic()
    with event.install_listener("numba:compile", counter):
        for name, kinds in signatures.read().items():
            for kind in kinds:
                kernel_named(name).compile(tuple(map(signatures.as_types, kind)))
    if not options.quiet:
        seconds = time.monotonic() - start
        done = f"{plural(counter.count, 'kernel')} compiled in {seconds:.0f} s, into {folder}"
        say(done if counter.count else "all kernels were compiled already")
