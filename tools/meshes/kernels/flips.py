"""Flips of edges of a mesh that bring triangles closer to the normals, or improve their shape.

`triangles` (k, 3) are the vertices of triangles. `sides` (k, 3) are 1 or −1: the side of the
surface on which the triangle lies at each corner; it changes on one-sided surfaces. `neighbours`
(k, 3) are the triangles across the edges opposite to the corners, −1 for none.
"""

from __future__ import annotations

from ....generated.mesh import corner_cotangents, corner_products
from ....runtime.base.tolerances import QUALITY_GAIN
from ....runtime.directions.kernels.vectors import row_vector
from ....runtime.machine_code.jit import inline, jit, loop


@loop
def smallest_cosine(points, normals, a, b, c, side_a, side_b, side_c):
    """Return the smallest cosine between a triangle's normal and those at its corners a, b, c.

    It is −2 if the triangle has no normal. The corners are sorted first, so that rounding does not
    depend on their order, and triangles without area cause no endless flips.
    """
    side = 1.0
    if a > b:
        a, b, side_a, side_b, side = b, a, side_b, side_a, -side
    if b > c:
        b, c, side_b, side_c, side = c, b, side_c, side_b, -side
    if a > b:
        a, b, side_a, side_b, side = b, a, side_b, side_a, -side
    s0, s1, s2, L = corner_products(
        row_vector(points, a),
        row_vector(points, b),
        row_vector(points, c),
        row_vector(normals, a),
        row_vector(normals, b),
        row_vector(normals, c),
    )
    return min(s0 * side_a * side, s1 * side_b * side, s2 * side_c * side) / L if L > 0.0 else -2.0


@jit
def smallest_cosines(points, normals, triangles, sides, cosines):
    """Write the smallest cosine between each triangle's normal and the normals at its corners."""
    for t in range(triangles.shape[0]):
        cosines[t] = smallest_cosine(
            points,
            normals,
            triangles[t, 0],
            triangles[t, 1],
            triangles[t, 2],
            sides[t, 0],
            sides[t, 1],
            sides[t, 2],
        )


@loop
def smallest_tangent(points, a, b, c):
    """Return the tangent of the smallest angle of a triangle; 0 if it has no area.

    The corners are sorted, as in `smallest_cosine`.
    """
    if a > b:
        a, b = b, a
    if b > c:
        b, c = c, b
    if a > b:
        a, b = b, a
    c0, c1, c2, L = corner_cotangents(
        row_vector(points, a), row_vector(points, b), row_vector(points, c)
    )
    return L / max(c0, max(c1, c2)) if L > 0.0 else 0.0


@jit
def smallest_tangents(points, triangles, tangents):
    """Write the tangent of the smallest angle of each triangle (k,)."""
    for t in range(triangles.shape[0]):
        tangents[t] = smallest_tangent(points, triangles[t, 0], triangles[t, 1], triangles[t, 2])


@loop
def corner_of(triangles, t, vertex):
    """Return the index, 0 to 2, of the corner of a triangle at a vertex; −1 if there is none."""
    for k in range(3):
        if triangles[t, k] == vertex:
            return k
    return -1


@loop
def are_joined(triangles, neighbours, first, c, d):
    """Return whether an edge joins the vertices c, a corner of the triangle `first`, and d.

    Visits the triangles around c from `first` on, in both directions if c is on a boundary.
    """
    for way in range(1, 3):
        t = first
        came_over = (corner_of(triangles, t, c) + way) % 3
        while t >= 0:
            if corner_of(triangles, t, d) >= 0:
                return True
            corner = corner_of(triangles, t, c)
            over = 3 - corner - came_over
            following = neighbours[t, over]
            if following == first:
                return False
            if following >= 0:
                # Cross the edge from c to the third corner.
                shared = triangles[t, came_over]
                own = corner_of(triangles, following, c)
                came_over = 3 - own - corner_of(triangles, following, shared)
            t = following
    return False


@loop
def replace_neighbour(neighbours, triangles, t, old, new, left, right):
    """Replace the neighbour `old` of triangle t, across the edge from left to right, by `new`.

    Do nothing if t is −1.
    """
    if t >= 0:
        for k in range(3):
            if neighbours[t, k] == old and triangles[t, k] != left and triangles[t, k] != right:
                neighbours[t, k] = new


@inline
def write_row(array, t, x, y, z):
    """Write a row of an array (k, 3)."""
    array[t, 0] = x
    array[t, 1] = y
    array[t, 2] = z


@loop
def flip_edge(points, normals, triangles, sides, neighbours, by_shape, least, t, k):
    """Flip the edge of triangle t opposite to its corner k if that improves the two triangles.

    The edge a b of the triangles c a b and d b a becomes the edge c d of c a d and d b c. The flip
    must raise the smallest cosine of the two triangles or, `by_shape`, the tangent of their
    smallest angle; the other one of these two numbers may fall, but not below `least`. Returns the
    triangle across the edge, or −1 without a flip.
    """
    other = neighbours[t, k]
    if other < 0:
        return -1
    ka, kb = (k + 1) % 3, (k + 2) % 3
    a, b, c = triangles[t, ka], triangles[t, kb], triangles[t, k]
    oa, ob = corner_of(triangles, other, a), corner_of(triangles, other, b)
    od = 3 - oa - ob
    d = triangles[other, od]
    turned = sides[t, ka] * sides[other, oa]
    if d == c or turned != sides[t, kb] * sides[other, ob]:
        return -1
    if by_shape or least > 0.0:
        now = min(smallest_tangent(points, c, a, b), smallest_tangent(points, d, b, a))
        then = min(smallest_tangent(points, c, a, d), smallest_tangent(points, d, b, c))
        if then <= (now + QUALITY_GAIN if by_shape else min(now, least)):
            return -1
    side_a, side_b, side_c = sides[t, ka], sides[t, kb], sides[t, k]
    side_d = turned * sides[other, od]
    before = min(
        smallest_cosine(points, normals, c, a, b, side_c, side_a, side_b),
        smallest_cosine(points, normals, d, b, a, side_d, side_b, side_a),
    )
    limit = min(before, least) if by_shape else before + QUALITY_GAIN
    left = smallest_cosine(points, normals, c, a, d, side_c, side_a, side_d)
    if left <= limit:
        return -1
    right = smallest_cosine(points, normals, d, b, c, side_d, side_b, side_c)
    if right <= limit or are_joined(triangles, neighbours, t, c, d):
        return -1
    across_bc, across_ca = neighbours[t, ka], neighbours[t, kb]
    across_ad, across_db = neighbours[other, ob], neighbours[other, oa]
    write_row(triangles, t, c, a, d)
    write_row(sides, t, side_c, side_a, side_d)
    write_row(neighbours, t, across_ad, other, across_ca)
    write_row(triangles, other, d, b, c)
    write_row(sides, other, side_d, side_b, side_c)
    write_row(neighbours, other, across_bc, t, across_db)
    replace_neighbour(neighbours, triangles, across_ad, other, t, a, d)
    replace_neighbour(neighbours, triangles, across_bc, t, other, b, c)
    return other


@jit
def flip_edges(points, normals, triangles, sides, neighbours, by_shape, least, queue, is_queued):
    """Flip edges while this improves two triangles, see `flip_edge`; return the number of flips.

    `triangles`, `sides` and `neighbours` (k, 3) are changed in place. Initially, queue (k,) must
    hold all triangles, and is_queued (k,) must be True. No flip makes a second edge between two
    vertices. The algorithm terminates: each flip raises the sorted cosines, or the sorted tangents,
    of all triangles lexicographically.
    """
    count = triangles.shape[0]
    head, waiting, flips = 0, count, 0
    while waiting > 0:
        t = queue[head]
        head, waiting = (head + 1) % count, waiting - 1
        is_queued[t] = False
        for k in range(3):
            other = flip_edge(points, normals, triangles, sides, neighbours, by_shape, least, t, k)
            if other >= 0:
                flips += 1
                for again in (t, other):
                    if not is_queued[again]:
                        queue[(head + waiting) % count] = again
                        waiting += 1
                        is_queued[again] = True
                break
    return flips
