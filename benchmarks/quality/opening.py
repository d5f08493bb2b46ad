"""The opening of docs/quality.md: a summary of the tables of the page."""

from __future__ import annotations

from collections.abc import Sequence

from gaussmap.docs.markdown import listed, markdown, wrapped

from ..peers.opening import TITLE, tables

# Columns of points and of meshes, and their meanings. Good samples have small values.
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
OWN = ("**balanced**", "**aligned**")
OF_MESH = ', prefer="normals"'
OTHERS = ("Open3D", "PyMeshLab", "Gmsh", "Open CASCADE", "grid of parameters")
SMALL = 1e-300  # instead of 0, in quotients

WORDS = """\
On each of {surfaces} surfaces, two densities of gaussmap are compared with the best of all other
tools, at about 10,000 points: **balanced**, the default, and **aligned**, which is for parameters
along lines of curvature. The quotient is the error of gaussmap divided by the smallest error of the
other tools: below 1, gaussmap is better.

- **Take gaussmap where normals count**: for E, G and the worst angle of meshes **balanced** is
  better than all others in {balanced} comparisons, **aligned** in {aligned}. The last column names
  the tools that are best where neither density is.
- **Take another tool where distances count**: for the largest gap in space **balanced** is best in
  {gaps} comparisons, **aligned** in {gaps_aligned}. Triangles of Gmsh have a better shape, and Open
  CASCADE meshes solids made of planes, cylinders and tori with a row of triangles for each angle.
- **Take another tool where time counts**: **balanced** is {slow} as fast as Poisson disks, and
  faster in {fast} of {timed} comparisons.
"""

BESIDE_GMSH = """\
The table compares E and G, in degrees, of the densities of gaussmap and of Gmsh with a size by
curvature, at about 10,000 points. Where parameters run along lines of curvature, **aligned** wins:
its E is {aligned} that of Gmsh on {wins} of {surfaces} surfaces. E of **balanced**, the default, is
{balanced} % larger than that of Gmsh on {first}; over all surfaces it is {all} that of Gmsh.
**gauss** has the smallest G on {gauss} of {surfaces} surfaces, and a large E where K ≈ 0.
"""
GMSH, GAUSS = "Gmsh, curvature size", "**gauss**"
FIRST = 3  # surfaces that the README compares

Table = list[dict[str, str]]


def beside_gmsh(text: str) -> str:
    """Return a table of E and G of densities and Gmsh, with its summary, from a page's tables."""
    titles = (GAUSS, *OWN, GMSH)
    errors: dict[str, dict[str, tuple[float, float]]] = {}
    for surface, (rows, *_) in tables(text, "mean E").items():
        known = {x[""]: x for x in rows if not x.get("E", "–").startswith("–")}
        if set(titles) <= set(known):
            errors[surface] = {x: (float(known[x]["E"]), float(known[x]["G"])) for x in titles}
    if not errors:
        return ""
    rows = [[label, *(" / ".join(f"{e:.2f}" for e in found[x]) for x in titles)]
            for label, found in errors.items()]  # fmt: skip
    ratios = {x: [found[x][0] / found[GMSH][0] for found in errors.values()] for x in OWN}
    larger = [
        f"{100 * x - 100:.0f}" for x in (min(ratios[OWN[0]][:FIRST]), max(ratios[OWN[0]][:FIRST]))
    ]
    won = [x for x in ratios[OWN[1]] if x < 1]
    words = BESIDE_GMSH.format(
        aligned=f"{min(won):.2f} to {max(won):.2f} times" if won else "never below",
        wins=len(won),
        surfaces=len(errors),
        balanced=" to ".join(larger),
        first=f"the first {FIRST}" if len(errors) > FIRST else "these",
        all=f"{min(ratios[OWN[0]]):.2f} to {max(ratios[OWN[0]]):.2f} times",
        gauss=sum(x[GAUSS][1] == min(y[1] for y in x.values()) for x in errors.values()),
    )
    return f"{wrapped(words)}\n{markdown(['E / G', *titles], rows)}"


def opening(text: str) -> str:
    """Return the opening of a page, from its tables of all surfaces."""
    points = [rows for rows, *_ in tables(text, "mean E").values()]
    meshes = [rows for rows, *_ in tables(text, "worst angle").values()]
    speeds = [
        float(x["balanced"].removesuffix(" ×").replace(",", ""))
        for rows in points
        for x in rows
        if "Poisson disk" in x[""] and x["balanced"].endswith("×")
    ]
    ends = [f"{x:.2g}" for x in (min(speeds), max(speeds))] if speeds else ["?"]
    rows = [_row(name, points, "", what) for name, what in OF_POINTS.items()]
    rows += [_row(name, meshes, OF_MESH, what) for name, what in OF_MESHES.items()]
    words = WORDS.format(
        surfaces=len(points),
        balanced=_wins(rows, 2, "E", "G", "worst angle"),
        aligned=_wins(rows, 4, "E", "G", "worst angle"),
        gaps=_wins(rows, 2, "gap"),
        gaps_aligned=_wins(rows, 4, "gap"),
        slow=f"{' to '.join(dict.fromkeys(ends))} times",
        fast=sum(x > 1 for x in speeds),
        timed=len(speeds),
    )
    header = ["what is to be small", ""]
    header += [x for own in OWN for x in (f"{own} is best on", "quotient")]
    header += ["best where neither is"]
    table = markdown(header, rows)
    return "\n".join(filter(None, [f"{TITLE}\n\n{wrapped(words)}", table, beside_gmsh(text)]))


def _wins(rows: list[list[str]], column: int, *names: str) -> str:
    """Return the number of comparisons in which a density is best, of all, as text."""
    pairs = [x[column].split(" of ") for x in rows if x[1] in names]
    wins, all_of_them = (sum(map(int, x)) for x in zip(*pairs, strict=True))
    return f"{wins} of {all_of_them}"


def _row(name: str, surfaces: list[Table], which: str, what: str) -> list[str]:
    """Return a row: each density's number of wins and quotients, and the best tools elsewhere."""
    quotients: list[list[float]] = []
    better: dict[str, int] = {}
    for rows in surfaces:
        errors = {
            x[""]: float(x[name])
            for x in rows
            if x[""].startswith(OTHERS) and not x.get(name, "–").startswith("–")
        }
        if not errors:
            continue
        best = min(errors, key=lambda x: errors[x])
        mine = [float(x[name]) for own in OWN for x in rows if x[""] == own + which]
        quotients.append([(x + SMALL) / (errors[best] + SMALL) for x in mine])
        if min(quotients[-1]) > 1:
            better[best] = better.get(best, 0) + 1
    cells = [x for column in zip(*quotients, strict=True) for x in _wins_and_ends(column)]
    who = [f"{title} ({count})" for title, count in sorted(better.items(), key=lambda x: -x[1])]
    return [what, name, *(cells or ["0 of 0", "–"] * len(OWN)), listed(who) if who else "–"]


def _wins_and_ends(quotients: Sequence[float]) -> tuple[str, str]:
    """Return two texts: the number of quotients below 1, of all, and the range of quotients."""
    wins = sum(x < 1 for x in quotients)
    return f"{wins} of {len(quotients)}", f"{min(quotients):.2f} to {max(quotients):.2f}"
