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


NODE = 1.0 / 6.0
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


@jit
def edge_over_surface(p0_x, p0_y, p0_z, p1_x, p1_y, p1_z, n0_x, n0_y, n0_z, n1_x, n1_y, n1_z):
    """The middle Bézier point of a quadratic curve from p0 to p1 that is as nearly as possible
    perpendicular to the unit normals n0 and n1 at its ends.

        e = p1 - p0
        beta = - (e·n0 - e·n1)/(4*(n0·n1 + 1))
        b = beta*(n0 + n1) + p0/2 + p1/2

    Source: beyond the paper; 40 operations as written, 40 here.
    """
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    beta = (
        -0.25
        * (e_x * n0_x - e_x * n1_x + e_y * n0_y - e_y * n1_y + e_z * n0_z - e_z * n1_z)
        / (n0_x * n1_x + n0_y * n1_y + n0_z * n1_z + 1)
    )
    b_x = beta * (n0_x + n1_x) + 0.5 * p0_x + 0.5 * p1_x
    b_y = beta * (n0_y + n1_y) + 0.5 * p0_y + 0.5 * p1_y
    b_z = beta * (n0_z + n1_z) + 0.5 * p0_z + 0.5 * p1_z
    return b_x, b_y, b_z


@jit
def power_form(
    b200_x, b200_y, b200_z, b020_x, b020_y, b020_z, b002_x, b002_y, b002_z, b110_x, b110_y,
    b110_z, b101_x, b101_y, b101_z, b011_x, b011_y, b011_z
):  # fmt: skip
    """The vectors of eq. (8), a = a_20, b = a_11, c = a_02, d = a_10, e = a_01 and p = a_00 in
    the paper, from the control points of a quadratic Bézier triangle.

        a = 2*b002 - 4*b101 + 2*b200
        b = 2*(b002 - b011 - b101 + b110)
        c = 2*b002 - 4*b011 + 2*b020
        d = 2*(b101 - b002)
        e = 2*(b011 - b002)
        p = b002

    Source: eqs. (8) and (10); 69 operations as written, 54 here.
    """
    t0 = 2 * b002_x
    a_x = 2 * b200_x - 4 * b101_x + t0
    t1 = 2 * b002_y
    a_y = 2 * b200_y - 4 * b101_y + t1
    t2 = 2 * b002_z
    a_z = 2 * b200_z - 4 * b101_z + t2
    t3 = -2 * b011_x
    t4 = t0 - 2 * b101_x
    b_x = 2 * b110_x + t3 + t4
    t5 = -2 * b011_y
    t6 = t1 - 2 * b101_y
    b_y = 2 * b110_y + t5 + t6
    t7 = -2 * b011_z
    t8 = t2 - 2 * b101_z
    b_z = 2 * b110_z + t7 + t8
    c_x = 2 * b020_x - 4 * b011_x + t0
    c_y = 2 * b020_y - 4 * b011_y + t1
    c_z = 2 * b020_z - 4 * b011_z + t2
    d_x = -t4
    d_y = -t6
    d_z = -t8
    e_x = -t0 - t3
    e_y = -t1 - t5
    e_z = -t2 - t7
    p_x = b002_x
    p_y = b002_y
    p_z = b002_z
    return a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z


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


# --- areas ----------------------------------------------------------------------------------------


@jit
def corner_areas(points, normals, triangles, sides, areas):
    """Write the part of the area of the surface over each triangle (k, 3) that belongs to its corners.

    The surface is taken as a quadratic Bezier triangle that the normals bend; a place belongs to the
    corners by its barycentric coordinates. Normals more than 90 degrees apart bend nothing.
    """
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
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
        n0_x *= sides[t, 0]
        n0_y *= sides[t, 0]
        n0_z *= sides[t, 0]
        n1_x *= sides[t, 1]
        n1_y *= sides[t, 1]
        n1_z *= sides[t, 1]
        n2_x *= sides[t, 2]
        n2_y *= sides[t, 2]
        n2_z *= sides[t, 2]
        if (
            min(
                n0_x * n1_x + n0_y * n1_y + n0_z * n1_z,
                n0_x * n2_x + n0_y * n2_y + n0_z * n2_z,
                n1_x * n2_x + n1_y * n2_y + n1_z * n2_z,
            )
            < 0.0
        ):
            n0_x = 0.0
            n0_y = 0.0
            n0_z = 0.0
            n1_x = 0.0
            n1_y = 0.0
            n1_z = 0.0
            n2_x = 0.0
            n2_y = 0.0
            n2_z = 0.0
        b200_x = p0_x
        b200_y = p0_y
        b200_z = p0_z
        b020_x = p1_x
        b020_y = p1_y
        b020_z = p1_z
        b002_x = p2_x
        b002_y = p2_y
        b002_z = p2_z
        b110_x, b110_y, b110_z = edge_over_surface(
            p0_x, p0_y, p0_z, p1_x, p1_y, p1_z, n0_x, n0_y, n0_z, n1_x, n1_y, n1_z
        )
        b101_x, b101_y, b101_z = edge_over_surface(
            p0_x, p0_y, p0_z, p2_x, p2_y, p2_z, n0_x, n0_y, n0_z, n2_x, n2_y, n2_z
        )
        b011_x, b011_y, b011_z = edge_over_surface(
            p1_x, p1_y, p1_z, p2_x, p2_y, p2_z, n1_x, n1_y, n1_z, n2_x, n2_y, n2_z
        )
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z = power_form(
            b200_x, b200_y, b200_z, b020_x, b020_y, b020_z, b002_x, b002_y, b002_z, b110_x, b110_y,
            b110_z, b101_x, b101_y, b101_z, b011_x, b011_y, b011_z
        )  # fmt: skip
        areas[t, 0] = areas[t, 1] = areas[t, 2] = 0.0
        for node in range(3):
            u = 1.0 - 2.0 * NODE if node == 0 else NODE
            v = 1.0 - 2.0 * NODE if node == 1 else NODE
            # tangents (eqs. (1) and (14)): 33 operations as written, 33 here
            p_u_x = a_x * u + b_x * v + d_x
            p_u_y = a_y * u + b_y * v + d_y
            p_u_z = a_z * u + b_z * v + d_z
            p_v_x = b_x * u + c_x * v + e_x
            p_v_y = b_y * u + c_y * v + e_y
            p_v_z = b_z * u + c_z * v + e_z
            N_x = p_u_y * p_v_z - p_u_z * p_v_y
            N_y = p_u_z * p_v_x - p_u_x * p_v_z
            N_z = p_u_x * p_v_y - p_u_y * p_v_x
            area = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z) / 6.0
            areas[t, 0] += u * area
            areas[t, 1] += v * area
            areas[t, 2] += (1.0 - u - v) * area
