"""The candidates nearest to the centres of the smallest balls around Voronoi cells."""

from __future__ import annotations

import math

from ...generated.vectors import Vector
from ..machine_code.jit import jit, loop
from .hash_grids import DENSITY

__all__ = ["link_cells", "move_to_centres"]

# Steps towards the centre of a ball (Badoiu and Clarkson, 2003).
STEPS = 12


@jit
def link_cells(nearest, heads, links):
    """Link the candidates (M,) nearest to each sample (N,) in lists.

    heads[number] is the first one, links[k] the one after k, −1 the end.
    """
    for k in range(nearest.size):
        if nearest[k] >= 0:
            links[k] = heads[nearest[k]]
            heads[nearest[k]] = k


@loop
def extreme_candidate(candidates, links, head, x, sign):
    """Return the candidate of a list that is farthest from x; the nearest one with sign = −1.

    Distances are multiplied by √w.
    """
    best = -math.inf
    found = head
    k = head
    while k >= 0:
        dx = candidates[k, 0] - x.x
        dy = candidates[k, 1] - x.y
        dz = candidates[k, 2] - x.z
        square = sign * (dx * dx + dy * dy + dz * dz) * candidates[k, DENSITY]
        if square > best:
            best = square
            found = k
        k = links[k]
    return found


@jit
def move_to_centres(candidates, heads, links, first, last, found):
    """Write the candidates at the centres of the cells of the samples first, …, last − 1.

    The centre of the smallest ball around a cell is approximated by steps of 1/2, 1/3, … of the way
    to the farthest candidate; the candidate nearest to it is written, −1 for an empty cell.
    """
    for number in range(first, last):
        head = heads[number]
        found[number] = head
        if head < 0:
            continue
        centre = Vector(candidates[head, 0], candidates[head, 1], candidates[head, 2])
        for step in range(STEPS):
            k = extreme_candidate(candidates, links, head, centre, 1.0)
            centre = Vector(
                centre.x + (candidates[k, 0] - centre.x) / (step + 2.0),
                centre.y + (candidates[k, 1] - centre.y) / (step + 2.0),
                centre.z + (candidates[k, 2] - centre.z) / (step + 2.0),
            )
        found[number] = extreme_candidate(candidates, links, head, centre, -1.0)
