"""`python -m gaussmap` and the command `gaussmap`: quick to start and to end, Ctrl-C included."""

from __future__ import annotations

import gc
import sys

__all__ = ["main"]


def main() -> int:
    """Run the command line with the arguments of the process; return the exit code.

    Ctrl-C ends it without a traceback also during the imports, which take a third of a second.
    What they make stays until the end of the process: that the garbage collector goes through it
    again and again, and once more at the end, would take as long.
    """
    gc.disable()
    try:
        from .runtime import cli
    except KeyboardInterrupt:
        print("gaussmap: interrupted", file=sys.stderr)
        return 130
    finally:
        gc.freeze()
        gc.enable()
    code = cli.main()
    gc.freeze()
    return code


if __name__ == "__main__":
    sys.exit(main())
