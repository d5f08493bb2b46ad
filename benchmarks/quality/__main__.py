"""Print docs/quality.md: `make quality`."""

from __future__ import annotations

import sys
import warnings

import gaussmap as gm
from tqdm import tqdm

from ..peers.forms import FORMS
from ..peers.untuned import UNTUNED
from .measure import measured
from .page import page
from .ways import WAYS


def main() -> None:
    """Measure all and print the page; progress goes to standard error."""
    warnings.simplefilter("ignore", gm.GaussmapWarning)
    forms = (*FORMS, *UNTUNED)
    with tqdm(total=len(forms) * len(WAYS), desc="judging", disable=None, file=sys.stderr) as bar:

        def done(title: str) -> None:
            bar.set_postfix_str(title, refresh=False)
            bar.update()

        surfaces = [measured(form, WAYS, done) for form in forms]
    print(page(surfaces, WAYS), end="")


if __name__ == "__main__":
    main()
