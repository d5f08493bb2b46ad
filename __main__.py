"""`python -m gaussmap`: the command line, as `gaussmap` on the path runs it."""

from __future__ import annotations

import sys

from .runtime.cli import main

if __name__ == "__main__":
    sys.exit(main())
