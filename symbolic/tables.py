"""Tables of constants, as source for Numba: the grid and the icosahedron."""

import textwrap
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, cast

import sympy as sp

from . import icosahedron, spline

# The number of points of a difference formula; the order of a central difference is one less.
STENCIL = 9
WIDTH = 106  # of the longest row of small numbers
SHORT = 20


def grid() -> str:
    """Return the constants of the grid, as source: which coefficients and vertices formulas read.

    NEIGHBOURS and CORNERS have a row for each of the four patches of a cell: the positions,
    relative to the centre of the cell, of neighbouring coefficients, and of the corners b200 and
    b020 of the patch. VERTICES are the indices of the vertices that the formula
    `coefficient_from_vertices` reads, counted from the vertex one step south and west of the cell's
    vertices. TRIANGLE_NEIGHBOURS are the indices, from 0 to 8, of the coefficients that the formula
    `triangle` reads.
    """
    neighbours, corners = (
        [[list(spline.quarter_turns(x, turns)) for x in places] for turns in range(4)]
        for places in (
            spline.NEIGHBOURS.values(),
            [[float(x) for x in spline.SOUTH[key]] for key in ("200", "020")],
        )
    )
    read = [k for k, x in enumerate(spline.MU.values()) if x in spline.TRIANGLE.inputs]
    vertices = [
        [int(s + Fraction(3, 2)), int(t + Fraction(3, 2))]
        for points in spline.VERTEX_ORBITS.values()
        for s, t in points
    ]
    return "\n".join(
        [
            f"SCALE = {spline.SCALE}.0",
            _array("NEIGHBOURS", neighbours),
            _array("CORNERS", corners),
            _array("TRIANGLE_NEIGHBOURS", read),
            _array("VERTICES", vertices),
        ]
    )


def differences() -> str:
    """Return tables of finite-difference weights for first and second derivatives at 0, as source.

    Each table has a row for each shift from −4 to 4; the nodes of this row are the nine integers
    from shift − 4 to shift + 4. Two more tables have the differences from the weights of the
    formula without the two nodes farthest from 0.
    """
    half = STENCIL // 2
    rows = [[shift + x for x in range(-half, half + 1)] for shift in range(-half, half + 1)]
    lines = ["# A row for each shift of the points, from -4 to 4, and its weights."]
    for order, name in ((1, "FIRST"), (2, "SECOND")):
        lines.append(_array(name, [[float(x) for x in _weights(order, y)] for y in rows]))
    lines.append("# What two points less, those farthest away, change in these weights.")
    for order, name in ((1, "FIRST_CHANGE"), (2, "SECOND_CHANGE")):
        lines.append(_array(name, [[float(x) for x in _changes(order, y)] for y in rows]))
    return "\n".join(lines)


def _weights(order: int, places: Sequence[int]) -> list[sp.Expr]:
    """Return the weights of the values at given nodes in a derivative at zero."""
    weights: Any = sp.finite_diff_weights(order, list(places), cast(Any, 0))
    return weights[order][-1]


def _changes(order: int, places: Sequence[int]) -> list[sp.Expr]:
    """Return the weights minus those of the formula without the two nodes farthest from zero."""
    near = sorted(sorted(places, key=abs)[:-2])
    fewer = dict(zip(near, _weights(order, near), strict=True))
    pairs = zip(places, _weights(order, places), strict=True)
    return [weight - fewer.get(place, sp.S.Zero) for place, weight in pairs]


def icosahedron_tables() -> str:
    """Return the tables of the icosahedron, each after a comment."""
    return "\n".join(
        f"{textwrap.fill(comment, 96, initial_indent='# ', subsequent_indent='# ')}\n"
        + (f"{name} = {table!r}" if isinstance(table, float) else _array(name, table))
        for name, (comment, table) in icosahedron.tables().items()
    )


def _array(name: str, values: Sequence[object]) -> str:
    """Return the source of a constant array; long rows have lines of their own."""
    text = f"{name} = np.array({values})"
    if len(text) <= WIDTH:
        return text
    rows = [repr(x) for x in values]
    if min(map(len, rows)) < SHORT:
        rows = [", ".join(rows)]
    lines = [line for x in rows for line in textwrap.wrap(f"{x},", WIDTH, break_on_hyphens=False)]
    filled = textwrap.indent("\n".join(lines), "    ")
    return f"{name} = np.array([\n{filled}\n])  # fmt: skip"
