"""`python -m gaussmap.symbolic`: write generated/, or with --check show what is stale."""

import argparse
import sys
from pathlib import Path

from .files import GENERATED, PROJECT, derive, differences, write

NEEDS_A_CHECKOUT = (
    "this gaussmap is an installed package, and its kernels stay those of its version. To change "
    "formulas, clone the repository, and run `make generate` there (see CONTRIBUTING.md); for the "
    "kernel of a formula of your own, see `gaussmap.symbolic.emit.function`."
)


def main(arguments: list[str] | None = None, folder: Path = GENERATED) -> int:
    """Write the generated files to a folder, or compare them with it.

    Return the exit code: 1 if the folder is stale, else 0.
    """
    parser = argparse.ArgumentParser(prog="python -m gaussmap.symbolic", description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="write nothing; show a diff and fail if stale"
    )
    check = parser.parse_args(arguments).check
    if folder == GENERATED and not PROJECT.exists():
        parser.error(NEEDS_A_CHECKOUT)
    texts = derive()
    if not check:
        write(texts, folder)
        return 0
    stale = differences(texts, folder)
    sys.stdout.writelines(stale)
    if stale:
        print("generated/ is stale: run `make generate` and commit the result", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
