"""`python -m gaussmap` and the command `gaussmap`: quick to start and to end, Ctrl-C included."""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from contextlib import suppress

__all__ = ["main"]

INTERRUPTED = 130


def main() -> int:
    """Run the command line with the arguments of the process; return the exit code.

    The process must end afterwards. Ctrl-C ends it without a traceback, also during the imports,
    which take a third of a second; it is ignored after the work. The garbage collector is off
    during the imports, and later skips the objects that they made: its passes, one of them at the
    end of the process, would take as long as the imports.
    """
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heard:
        signal.signal(signal.SIGINT, _leave)
    gc.disable()
    from .tools.commands import cli

    def ready() -> None:
        gc.freeze()
        gc.enable()
        if heard:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    code = cli.main(ready=ready)
    if heard:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    if code == INTERRUPTED and threading.active_count() > 1:
        os._exit(code)  # threads may be inside of a long compiled call
    gc.freeze()
    return code


def _leave(*_: object) -> None:
    # No KeyboardInterrupt is raised: a module that is being imported might handle it as an error.
    with suppress(OSError):
        os.write(2, b"gaussmap: interrupted\n")
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    sys.exit(main())
