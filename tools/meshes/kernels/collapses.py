"""Collapses of edges that remove triangles with small angles from a mesh.

A vertex b is moved to a neighbour a: the two triangles at the edge a b vanish, and in the other
triangles around b it is replaced by a. The arrays are those of the module `flips`; the corners of a
triangle that has vanished are −1.
"""

from __future__ import annotations

from ....runtime.base.tolerances import QUALITY_GAIN
from ....runtime.machine_code.jit import jit, loop
from .flips import are_joined, corner_of, smallest_cosine, smallest_tangent

# A collapse, which moves b, may lower the smallest cosine between triangles and normals by this,
# even if the cosine is small.
COSINE_LOSS = 0.1


@loop
def find_fan(triangles, neighbours, first, b, a, fan):
    """Write the indices of the triangles around b to `fan`; the first and last have the edge a b.

    The first of these triangles is `first`. Returns their number, or 0 if b is on a boundary, or
    there are more triangles than `fan` (n,) has room for.
    """
    t, over = first, corner_of(triangles, first, a)
    for k in range(fan.size):
        fan[k] = t
        following = neighbours[t, over]
        if following < 0:
            return 0
        # The next edge is opposite to the vertex that both triangles have besides b.
        shared = triangles[t, 3 - over - corner_of(triangles, t, b)]
        over, t = corner_of(triangles, following, shared), following
        if t == first:
            return k + 1
    return 0


@loop
def turn_between(triangles, sides, t, a, b):
    """Return −1 if triangle t lies on different sides of the surface at a and b, else 1."""
    return sides[t, corner_of(triangles, t, a)] * sides[t, corner_of(triangles, t, b)]


@loop
def tangent_with(points, triangles, t, b, a):
    """Return the tangent of the smallest angle of triangle t with b replaced by a."""
    k = corner_of(triangles, t, b)
    return smallest_tangent(points, a, triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3])


@loop
def cosine_with(points, normals, triangles, sides, t, b, a, turn):
    """Return the smallest cosine of triangle t with b replaced by a."""
    k = corner_of(triangles, t, b)
    i, j = (k + 1) % 3, (k + 2) % 3
    return smallest_cosine(
        points,
        normals,
        a,
        triangles[t, i],
        triangles[t, j],
        turn * sides[t, k],
        sides[t, i],
        sides[t, j],
    )


@loop
def tangent_after(points, normals, triangles, sides, neighbours, least, first, b, a, fan):
    """Return the smallest tangent around b after b is moved to a, or −1 if that is not allowed.

    `first` is a triangle with both corners. The move is allowed if five conditions hold: the
    smallest tangent rises; the smallest cosine is at least `least` afterwards, or falls by at most
    COSINE_LOSS; b is not on a boundary; the mesh remains a surface; both triangles at the edge a b
    have the same product of their sides at a and b.
    """
    count = find_fan(triangles, neighbours, first, b, a, fan)
    if count == 0:
        return -1.0
    other, turn = fan[count - 1], turn_between(triangles, sides, first, a, b)
    if turn_between(triangles, sides, other, a, b) != turn:
        return -1.0
    before = min(
        tangent_with(points, triangles, first, b, b), tangent_with(points, triangles, other, b, b)
    )
    after, cosine_before, cosine_after = 2.0, 1.0, 1.0  # tan 60° is 1.73
    for t in fan[1 : count - 1]:
        before = min(before, tangent_with(points, triangles, t, b, b))
        after = min(after, tangent_with(points, triangles, t, b, a))
        now = cosine_with(points, normals, triangles, sides, t, b, b, 1)
        cosine_before = min(cosine_before, now)
        then = cosine_with(points, normals, triangles, sides, t, b, a, turn)
        cosine_after = min(cosine_after, then)
    is_better = before + QUALITY_GAIN < after < 2.0
    is_folded = cosine_after < min(cosine_before - COSINE_LOSS, least)
    if is_folded or not is_better or have_other_neighbours(triangles, neighbours, b, a, fan, count):
        return -1.0
    return after


@loop
def have_other_neighbours(triangles, neighbours, b, a, fan, count):
    """Return whether a and b have common neighbours besides the vertices opposite to their edge."""
    first, other = fan[0], fan[count - 1]
    for t in fan[1 : count - 1]:
        for k in range(3):
            vertex = triangles[t, k]
            is_beside = corner_of(triangles, first, vertex) + corner_of(triangles, other, vertex)
            if vertex == a or (
                is_beside == -2 and are_joined(triangles, neighbours, first, a, vertex)
            ):
                return True
    return False


@loop
def remove_triangle(triangles, neighbours, t, b, a):
    """Remove a triangle at the edge a b, and link the triangles across its other two edges."""
    across_a = neighbours[t, corner_of(triangles, t, a)]
    across_b = neighbours[t, corner_of(triangles, t, b)]
    for k in range(3):
        if across_a >= 0 and neighbours[across_a, k] == t:
            neighbours[across_a, k] = across_b
        if across_b >= 0 and neighbours[across_b, k] == t:
            neighbours[across_b, k] = across_a
    for k in range(3):
        triangles[t, k] = -1
        neighbours[t, k] = -1


@loop
def collapse_edge(triangles, sides, neighbours, first, b, a, fan):
    """Move the vertex b to the vertex a; both are corners of the triangle `first`."""
    turn = turn_between(triangles, sides, first, a, b)
    count = find_fan(triangles, neighbours, first, b, a, fan)
    for t in fan[1 : count - 1]:
        k = corner_of(triangles, t, b)
        triangles[t, k] = a
        sides[t, k] *= turn
    remove_triangle(triangles, neighbours, first, b, a)
    remove_triangle(triangles, neighbours, fan[count - 1], b, a)


@jit
def collapse_edges(points, normals, triangles, sides, neighbours, is_free, smallest, least, fan):
    """Collapse edges of triangles with small angles if these grow; return the number of collapses.

    A triangle is treated if the tangent of its smallest angle is below `smallest`. Of all collapses
    of its edges that move a free vertex, the best one is made: the one after which the smallest
    tangent is largest. `fan` (n,) is workspace for the triangles around a vertex.
    """
    collapses = 0
    for t in range(triangles.shape[0]):
        x, y, z = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if x < 0 or smallest_tangent(points, x, y, z) >= smallest:
            continue
        largest, b, a = 0.0, x, x
        for k in range(6):
            i, j = triangles[t, k % 3], triangles[t, (k + 1 + k // 3) % 3]
            if is_free[i]:
                tangent = tangent_after(
                    points, normals, triangles, sides, neighbours, least, t, i, j, fan
                )
                if tangent > largest:
                    largest, b, a = tangent, i, j
        if largest > 0.0:
            collapse_edge(triangles, sides, neighbours, t, b, a, fan)
            collapses += 1
    return collapses
