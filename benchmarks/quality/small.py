"""Small counts: densities of gaussmap beside a plain grid of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gaussmap.docs.orders import markdown, wrapped

from ..peers.forms import ClosedForm
from ..peers.measure import nearest_by_tree
from ..peers.metrics import Errors, Places, errors
from ..peers.peer import Peer, Work
from .ways import ALIGNED, BALANCED, GAUSS

__all__ = ["COUNTS", "Few", "few", "section"]

COUNTS = (200, 500)


def by_grid(form: ClosedForm, count: int) -> Work:
    """Prepare a grid of parameters whose cells have a good shape."""
    return lambda: tuple(x.reshape(-1, 3) for x in form.evaluate(*form.lattice(count)))  # pyright: ignore[reportReturnType]


GRID = Peer("grid of parameters", "", "numpy", by_grid, 0, rounds=1)
WAYS = (GAUSS, BALANCED, ALIGNED, GRID)

WORDS = """\
At {counts} points, E / mean E / G in degrees. A grid of parameters has a smaller E than
**balanced** in {worse} of {all} comparisons; **aligned** has a smaller one than the grid in
{better} of {all}. For few points, take **aligned** or a grid.
"""


@dataclass(frozen=True)
class Few:
    """The errors of all ways on a surface at a count."""

    form: ClosedForm
    count: int
    errors: dict[Peer, Errors]


def few(forms: Sequence[ClosedForm]) -> list[Few]:
    """Judge all ways on surfaces at small counts."""
    found = []
    for form in forms:
        places = Places.of(form)
        for count in COUNTS:
            clouds = {way: way.prepare(form, count)() for way in WAYS}
            judged = {x: errors(form, places, *y, nearest_by_tree) for x, y in clouds.items()}
            found.append(Few(form, count, judged))
    return found


def section(found: Sequence[Few]) -> str:
    """Return the section of the page."""
    E = {way: [x.errors[way].E for x in found] for way in WAYS}
    pairs = list(zip(E[BALANCED], E[ALIGNED], E[GRID], strict=True))
    words = WORDS.format(
        counts=" and ".join(map(str, COUNTS)),
        worse=sum(grid < balanced for balanced, _, grid in pairs),
        all=len(pairs),
        better=sum(aligned < grid for _, aligned, grid in pairs),
    )
    header = ["E / mean E / G", "points", *(way.title for way in WAYS)]
    rows = [
        [x.form.name, str(x.count)]
        + [f"{e.E:.2f} / {e.mean:.2f} / {e.G:.2f}" for e in (x.errors[way] for way in WAYS)]
        for x in found
    ]
    return f"## Few points\n\n{wrapped(words)}\n{markdown(header, rows)}"
