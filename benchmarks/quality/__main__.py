"""Print docs/quality.md: `make quality`."""

from __future__ import annotations

import os
import sys
import warnings

import gaussmap as gm
from tqdm import tqdm

from .measure import measured
from .meshers import MESHERS
from .page import page
from .surfaces import JUDGED
from .ways import WAYS


def load() -> float | None:
    """Return the mean number of running processes of the last minute, per core."""
    return os.getloadavg()[0] / (os.cpu_count() or 1) if hasattr(os, "getloadavg") else None


def main() -> None:
    """Measure all and print the page; progress goes to standard error."""
    warnings.simplefilter("ignore", gm.GaussmapWarning)
    before, steps = load(), len(JUDGED) * (len(WAYS) + len(MESHERS))
    with tqdm(total=steps, desc="judging", disable=None, file=sys.stderr) as bar:

        def done(title: str) -> None:
            bar.set_postfix_str(title, refresh=False)
            bar.update()

        surfaces = [measured(form, WAYS, MESHERS, done) for form in JUDGED]
    print(page(surfaces, before), end="")


if __name__ == "__main__":
    main()
