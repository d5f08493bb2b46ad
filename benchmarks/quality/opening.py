"""How docs/quality.md opens: where gaussmap wins and where it does not, by its own tables."""

from __future__ import annotations

from gaussmap.docs.orders import listed, markdown, wrapped

from ..peers.opening import TITLE, tables

__all__ = ["opening"]

# What is small where samples are good: the column of points, or of meshes, and its meaning.
OF_POINTS = {
    "E": "the largest error of a normal, at the nearest sample in space",
    "mean E": "the same on average",
    "G": "the largest gap between normals",
    "plane": "the largest distance from the tangent planes of samples",
    "gap": "the largest gap in space",
}
OF_MESHES = {
    "worst angle": "mesh: the largest error of a normal",
    "mean angle": "mesh: the same on average",
    "Hausdorff distance": "mesh: the largest distance",
}
BALANCED = "**balanced**"
MESH = '**balanced**, prefer="normals"'
OTHERS = ("Open3D", "PyMeshLab", "Gmsh", "Open CASCADE", "grid of parameters")
SMALL = 1e-300  # instead of 0, in quotients

WORDS = """\
On each of {surfaces} surfaces, the default density of gaussmap is compared with the best of all
other tools, at about 10,000 points. A quotient is the error of the default relative to the smallest
one of the others: below 1, gaussmap is better.

- **Take gaussmap where normals count**: for E, G and the worst angle of meshes it is better than
  all others in {normals} comparisons. Where it is not, the others are those of the last column.
- **Take another tool where distances count**: for the largest gap in space gaussmap is best in
  {gaps} comparisons. Farthest points and Poisson disks are more even, triangles of Gmsh have a
  better shape, and Open CASCADE meshes solids made of planes, cylinders and tori with a row of
  triangles for each angle.
- **Take another tool where time counts**: **balanced** is {slow} as fast as Poisson disks, and
  faster in {fast} of {timed} comparisons.
"""

Table = list[dict[str, str]]


def opening(text: str) -> str:
    """Return the section of a page, from the tables that it has of each surface."""
    points = [rows for rows, *_ in tables(text, "mean E").values()]
    meshes = [rows for rows, *_ in tables(text, "worst angle").values()]
    speeds = [
        float(x["balanced"].removesuffix(" ×").replace(",", ""))
        for rows in points
        for x in rows
        if "Poisson disk" in x[""] and x["balanced"].endswith("×")
    ]
    ends = [f"{x:.2g}" for x in (min(speeds), max(speeds))] if speeds else ["?"]
    rows = [_row(name, points, BALANCED, what) for name, what in OF_POINTS.items()]
    rows += [_row(name, meshes, MESH, what) for name, what in OF_MESHES.items()]
    words = WORDS.format(
        surfaces=len(points),
        normals=_wins(rows, "E", "G", "worst angle"),
        gaps=_wins(rows, "gap"),
        slow=f"{' to '.join(dict.fromkeys(ends))} times",
        fast=sum(x > 1 for x in speeds),
        timed=len(speeds),
    )
    header = ["what is to be small", "", "gaussmap is best on", "quotient", "best of the others"]
    return f"{TITLE}\n\n{wrapped(words)}\n{markdown(header, rows)}"


def _wins(rows: list[list[str]], *names: str) -> str:
    """Return in how many comparisons gaussmap is best, of how many."""
    pairs = [x[2].split(" of ") for x in rows if x[1] in names]
    wins, all_of_them = (sum(map(int, x)) for x in zip(*pairs, strict=True))
    return f"{wins} of {all_of_them}"


def _row(name: str, surfaces: list[Table], own: str, what: str) -> list[str]:
    """Return one line: how often gaussmap is best, the quotients, and who is best elsewhere."""
    quotients, better = [], {}
    for rows in surfaces:
        mine = next(float(x[name]) for x in rows if x[""] == own)
        errors = {
            x[""]: float(x[name])
            for x in rows
            if x[""].startswith(OTHERS) and not x.get(name, "–").startswith("–")
        }
        if not errors:
            continue
        best = min(errors, key=lambda x: errors[x])
        quotients.append((mine + SMALL) / (errors[best] + SMALL))
        if quotients[-1] > 1:
            better[best] = better.get(best, 0) + 1
    wins = sum(x < 1 for x in quotients)
    who = [f"{title} ({count})" for title, count in sorted(better.items(), key=lambda x: -x[1])]
    ends = f"{min(quotients):.2f} to {max(quotients):.2f}" if quotients else "–"
    return [what, name, f"{wins} of {len(quotients)}", ends, listed(who) if who else "–"]
