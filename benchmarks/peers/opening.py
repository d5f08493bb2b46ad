"""The opening of docs/performance.md: a summary of the tables of the page."""

from __future__ import annotations

import re

from gaussmap.docs.markdown import listed, markdown, wrapped

TITLE = "## Where gaussmap wins, where it does not"

SPEED = "gaussmap, 10⁶"

WORDS = """\
Points with normals, of {surfaces} surfaces. None of the other packages takes normals and returns
the points that have them.

- **gaussmap is faster**, for 10⁶ points, than {faster} of {all} others, by up to {most}.
- **It is slower**, or not always faster, than {slower}.
- **Normals are represented well**: G is the largest angle between a normal of the surface and that
  of the nearest sample in normal space. gaussmap has the smaller G in {best} of {compared}
  comparisons.
- **Positions are represented badly** by points at given normals alone: such points are rare where
  the surface is nearly flat. E is the largest angle between the normals of a point and of its
  nearest sample in space. gaussmap has the smaller E in only {nearest} of {compared} comparisons.
  The default, `density="balanced"`, fills the gaps between such points, at less speed
  ([measured](quality.md)).

The table has the range of the speed of gaussmap relative to each of the other packages, for 10⁶
points, and the number of surfaces on which gaussmap has the smaller error. The columns are
explained below the table.
"""


def opening(text: str) -> str:
    """Return the opening of a page, from its tables of all surfaces."""
    found = [rows for rows, *_ in tables(text, SPEED).values()]
    others: dict[str, list[tuple[dict[str, str], dict[str, str]]]] = {}
    for mine, *rows in found:  # gaussmap comes first
        for x in rows:
            if x[SPEED].endswith("×"):
                others.setdefault(x[""], []).append((mine, x))
    speeds = {title: [_ratio(x[SPEED]) for _, x in pairs] for title, pairs in others.items()}
    order = sorted(speeds, key=lambda title: min(speeds[title]))
    better = {what: {x: _better(y, what) for x, y in others.items()} for what in ("E", "G")}
    slower = [x for x in order if min(speeds[x]) < 1]
    words = WORDS.format(
        surfaces=len(found),
        faster=len(order) - len(slower),
        all=len(order),
        most=_range([max(map(max, speeds.values()))]),
        slower=listed(f"{x} ({_range(speeds[x])})" for x in slower) if slower else "none of them",
        best=sum(better["G"].values()),
        nearest=sum(better["E"].values()),
        compared=sum(map(len, others.values())),
    )
    header = ["compared with", "speed of gaussmap", "smaller G", "smaller E"]
    rows = [
        [x, _range(speeds[x]), *(f"{better[y][x]} of {len(others[x])}" for y in ("G", "E"))]
        for x in order
    ]
    return f"{TITLE}\n\n{wrapped(words)}\n{markdown(header, rows)}"


def _better(pairs: list[tuple[dict[str, str], dict[str, str]]], what: str) -> int:
    """Return the number of surfaces on which gaussmap has the smaller error."""
    return sum(float(mine[what]) < float(other[what]) for mine, other in pairs)


def tables(text: str, column: str) -> dict[str, list[list[dict[str, str]]]]:
    """Return the rows of all tables that have a column, by the titles of their sections.

    The first column is called "".
    """
    found: dict[str, list[list[dict[str, str]]]] = {}
    for title, section in re.findall(r"^##+ (.*)\n((?:(?!##).*\n)*)", text, re.MULTILINE):
        for block in re.findall(r"(?:^\|.*\n)+", section, re.MULTILINE):
            header, _, *rows = map(_cells, block.splitlines())
            if column in header:
                table = [dict(zip(["", *header[1:]], x, strict=True)) for x in rows]
                found.setdefault(title, []).append(table)
    return found


def _cells(line: str) -> list[str]:
    return [x.strip() for x in re.split(r"(?<!\\)\|", line)[1:-1]]


def _ratio(cell: str) -> float:
    return float(cell.removesuffix(" ×").replace(",", ""))


def _range(values: list[float]) -> str:
    ends = dict.fromkeys(f"{x:,.0f}" if x >= 10 else f"{x:.2g}" for x in (min(values), max(values)))
    return f"{' to '.join(ends)} ×"
