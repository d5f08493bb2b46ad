"""Print docs/performance.md: `make bench-peers`."""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence

import gaussmap as gm
from tqdm import tqdm

from .. import scale
from .catalogue import PEERS
from .durations import measure_durations
from .forms import FORMS, ClosedForm
from .measure import judge_own, measure, measure_own
from .metrics import Places
from .page import OnSurface, page


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure all and print the page; progress goes to standard error."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=float, default=1e8, help="number of samples or patches")
    largest = int(parser.parse_args(arguments).largest)
    warnings.simplefilter("ignore", gm.GaussmapWarning)
    steps = len(FORMS) * (len(PEERS) + 1) + 1
    with tqdm(total=steps, desc="measuring", disable=None, file=sys.stderr) as bar:
        surfaces = [_on_surface(form, bar) for form in FORMS]
        bar.set_postfix_str("durations")
        taken = measure_durations(largest)
        series = scale.measure(largest)
        bar.update()
    print(page(surfaces, series, taken), end="")


def _on_surface(form: ClosedForm, bar: tqdm) -> OnSurface:
    places = Places.of(form)
    judged, own = judge_own(form, places), measure_own(form)
    bar.update()
    peers = []
    for peer in PEERS:
        bar.set_postfix_str(f"{form.name}: {peer.title}")
        peers.append(measure(form, places, peer))
        bar.update()
    return OnSurface(form, peers, own, judged)


if __name__ == "__main__":
    main()
