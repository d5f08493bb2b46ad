"""Triangles through samples: border points, flips of edges.

Written by `make generate` (python -m gaussmap.symbolic): do not edit, change symbolic/ instead.
SymPy 1.14.0. Passes: common subexpressions of all outputs together, in canonical order;
temporaries that are used once or are another name with a sign written back. float64, no
fast-math.
"""

import math

import numba
import numpy as np

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def jit(function):
    """Compile on the first call; keep the machine code on disk where a folder can be written."""
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    except RuntimeError:  # no writable cache folder
        return numba.njit(**OPTIONS)(function)


# A flip must raise the smallest cosine by more than rounding.
GAIN = 1e-14


# --- formulas -------------------------------------------------------------------------------------


@jit
def corner_products(
    p0_x, p0_y, p0_z, p1_x, p1_y, p1_z, p2_x, p2_y, p2_z, n0_x, n0_y, n0_z, n1_x, n1_y, n1_z,
    n2_x, n2_y, n2_z
):  # fmt: skip
    """How a triangle with the corners p0, p1, p2 lies to the surface: s0/L, s1/L and s2/L are
    the cosines of the angles between its normal and the unit normals n0, n1, n2 of the surface
    there. L is twice its area.

        e = p1 - p0
        f = p2 - p0
        N = e × f
        s0 = N·n0
        s1 = N·n1
        s2 = N·n2
        L = |N|

    Source: beyond the paper; 36 operations as written, 36 here.
    """
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    f_x = p2_x - p0_x
    f_y = p2_y - p0_y
    f_z = p2_z - p0_z
    N_x = e_y * f_z - e_z * f_y
    N_y = e_z * f_x - e_x * f_z
    N_z = e_x * f_y - e_y * f_x
    s0 = N_x * n0_x + N_y * n0_y + N_z * n0_z
    s1 = N_x * n1_x + N_y * n1_y + N_z * n1_z
    s2 = N_x * n2_x + N_y * n2_y + N_z * n2_z
    L = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
    return s0, s1, s2, L


@jit
def border_spacing(r, k):
    """How far apart points of a border are to be if the k-th nearest sample is r away: as far
    as samples are of which k fill half a disk of radius r.

        rho = 2*k/(pi*r**2)
        d = 1/sqrt(rho)

    Source: beyond the paper; 6 operations as written, 6 here.
    """
    rho = 2 * k / (math.pi * r * r)
    d = 1.0 / math.sqrt(rho)
    return d


# --- the border -----------------------------------------------------------------------------------


@jit
def border_spacings(distances, k, spacings):
    """Write the spacing of border points where the k-th nearest sample has these distances."""
    for i in range(distances.size):
        r = distances[i]
        d = border_spacing(r, k)
        spacings[i] = d


# --- triangles ------------------------------------------------------------------------------------


@jit
def smallest_cosine(points, normals, a, b, c, side_a, side_b, side_c):
    """Return the smallest of the cosines at the corners; -2 if the triangle has no normal.

    The corners are put in order, so that rounding is the same whichever of them comes first: it
    decides about triangles whose corners are nearly in line, and flips must not go round.
    """
    side = 1.0
    if a > b:
        a, b, side_a, side_b, side = b, a, side_b, side_a, -side
    if b > c:
        b, c, side_b, side_c, side = c, b, side_c, side_b, -side
    if a > b:
        a, b, side_a, side_b, side = b, a, side_b, side_a, -side
    p0_x = points[a, 0]
    p0_y = points[a, 1]
    p0_z = points[a, 2]
    p1_x = points[b, 0]
    p1_y = points[b, 1]
    p1_z = points[b, 2]
    p2_x = points[c, 0]
    p2_y = points[c, 1]
    p2_z = points[c, 2]
    n0_x = normals[a, 0]
    n0_y = normals[a, 1]
    n0_z = normals[a, 2]
    n1_x = normals[b, 0]
    n1_y = normals[b, 1]
    n1_z = normals[b, 2]
    n2_x = normals[c, 0]
    n2_y = normals[c, 1]
    n2_z = normals[c, 2]
    s0, s1, s2, L = corner_products(
        p0_x, p0_y, p0_z, p1_x, p1_y, p1_z, p2_x, p2_y, p2_z, n0_x, n0_y, n0_z, n1_x, n1_y, n1_z,
        n2_x, n2_y, n2_z
    )  # fmt: skip
    return min(s0 * side_a * side, s1 * side_b * side, s2 * side_c * side) / L if L > 0.0 else -2.0


@jit
def smallest_cosines(points, normals, triangles, sides, cosines):
    """Write the smallest cosine at the corners of each of the triangles (k, 3)."""
    for t in range(triangles.shape[0]):
        cosines[t] = smallest_cosine(
            points, normals, triangles[t, 0], triangles[t, 1], triangles[t, 2],
            sides[t, 0], sides[t, 1], sides[t, 2],
        )  # fmt: skip


@jit
def corner_of(triangles, t, vertex):
    """Return which corner of a triangle is a vertex, -1 if none."""
    for k in range(3):
        if triangles[t, k] == vertex:
            return k
    return -1


@jit
def are_joined(triangles, neighbours, first, c, d):
    """Say whether a triangle round the vertex c, starting from one of them, has the vertex d."""
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
                # The edge from c to the third corner is crossed; it lies opposite to another one.
                shared = triangles[t, came_over]
                own = corner_of(triangles, following, c)
                came_over = 3 - own - corner_of(triangles, following, shared)
            t = following
    return False


@jit
def meet_again(neighbours, triangles, t, old, new, left, right):
    """Tell a triangle t, which has the edge from left to right, its new neighbour there."""
    if t >= 0:
        for k in range(3):
            if neighbours[t, k] == old and triangles[t, k] != left and triangles[t, k] != right:
                neighbours[t, k] = new


@jit
def improve(points, normals, triangles, sides, neighbours, t, k):
    """Flip the edge of a triangle that lies opposite to its corner k, if the largest angle between
    the triangles and the normals falls; return the triangle beyond it, or -1 if nothing is done.

    The edge a b of the triangles c a b and d b a becomes the edge c d of c a d and d b c. `sides`
    tell on which side of the surface a triangle lies at its corners: 1 or -1, as its orientation
    agrees with that of the surface there; along a band of a one-sided surface they change.
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
    side_a, side_b, side_c = sides[t, ka], sides[t, kb], sides[t, k]
    side_d = turned * sides[other, od]
    before = min(
        smallest_cosine(points, normals, c, a, b, side_c, side_a, side_b),
        smallest_cosine(points, normals, d, b, a, side_d, side_b, side_a),
    )
    left = smallest_cosine(points, normals, c, a, d, side_c, side_a, side_d)
    if left <= before + GAIN:
        return -1
    right = smallest_cosine(points, normals, d, b, c, side_d, side_b, side_c)
    if right <= before + GAIN or are_joined(triangles, neighbours, t, c, d):
        return -1
    beside_bc, beside_ca = neighbours[t, ka], neighbours[t, kb]
    beside_ad, beside_db = neighbours[other, ob], neighbours[other, oa]
    triangles[t, 0], triangles[t, 1], triangles[t, 2] = c, a, d
    sides[t, 0], sides[t, 1], sides[t, 2] = side_c, side_a, side_d
    neighbours[t, 0], neighbours[t, 1], neighbours[t, 2] = beside_ad, other, beside_ca
    triangles[other, 0], triangles[other, 1], triangles[other, 2] = d, b, c
    sides[other, 0], sides[other, 1], sides[other, 2] = side_d, side_b, side_c
    neighbours[other, 0], neighbours[other, 1], neighbours[other, 2] = beside_bc, t, beside_db
    meet_again(neighbours, triangles, beside_ad, other, t, a, d)
    meet_again(neighbours, triangles, beside_bc, t, other, b, c)
    return other


@jit
def flip_edges(points, normals, triangles, sides, neighbours):
    """Flip edges of the triangles (k, 3) as long as that makes the largest angle between two
    triangles and the normals at their corners smaller; return how many flips that were.

    `neighbours` (k, 3) are the triangles beyond the edges opposite to the corners, -1 for none.
    No flip makes a second edge between two vertices. Each raises the smallest cosine of its two
    triangles, and so the ascending list of all: they end.
    """
    count = triangles.shape[0]
    waits = np.ones(count, dtype=np.bool_)
    queue = np.arange(count)
    head, waiting, flips = 0, count, 0
    while waiting > 0:
        t = queue[head]
        head, waiting = (head + 1) % count, waiting - 1
        waits[t] = False
        for k in range(3):
            other = improve(points, normals, triangles, sides, neighbours, t, k)
            if other >= 0:
                flips += 1
                for again in (t, other):
                    if not waits[again]:
                        queue[(head + waiting) % count] = again
                        waiting += 1
                        waits[again] = True
                break
    return flips
