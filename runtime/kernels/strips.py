"""The patches of a strip of cells: their vectors, cones of normals, and boxes on faces.

Rows of an array hold one number for each patch, so that loops over patches are vectorized.

Central projection preserves convex hulls: the projected control normals of a patch bound the
projection of all its normals. The planes are the faces of a polyhedron, a cube or an icosahedron;
a box bounds the two coordinates on a face, and their sum.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.patch import control_normals
from ...generated.spline import triangle
from ...generated.vectors import Patch, Vector
from ..base.tolerances import ANGLE_ERROR, FORM_ERROR, SHORT_CONTROL_NORMAL
from ..machine_code.jit import inline, loop
from .cone import tangent_bounds
from .developable import may_be_developable
from .patch import place_of, vector_at
from .tile import STEP, TILE, put, vector_in
from .vectors import dot, length

__all__ = [
    "AXIS",
    "BOUND",
    "BOX",
    "CELLS",
    "ERRORS",
    "FLAT",
    "ONE_VECTOR",
    "SINE",
    "UNIT",
    "Polyhedron",
    "Strip",
    "boxes_of",
    "patch_in",
    "put_box",
    "strip_of",
]

# The number of cells of a strip.
CELLS = TILE // 4
# The cosine of 37 degrees: control normals within this angle of the axis form a narrow cone.
NARROW = 0.8
# The starts of the parts of a strip: vectors of patches, their largest differences and noise;
# directions of control normals and their errors, cones; the frame of a face, the box there.
VECTORS, SPREAD, NOISE, UNIT, ERRORS, AXIS, SINE, BOUND, FLAT, FRAME, BOX = (
    np.int64(STEP * row) for row in (0, 15, 18, 19, 37, 43, 46, 47, 48, 49, 58)
)
ROWS, ZERO, ONE_VECTOR = 64, np.int64(0), np.int64(3 * STEP)


class Polyhedron(NamedTuple):
    """The faces of a polyhedron around the sphere, each with a grid.

    `frames` (F, 3, 3) map directions to s, t and height on a face, `stretch` is the largest length
    of their rows. Positions are (s/height + 1)/2 and (t/height + 1)/2 times `grid`; `limit` is the
    largest sum of both. The height of a unit vector on its face is `least` at least, and that of a
    vector in a cone at least that of the axis minus `slope` times the sine. `density` is the
    mean number of normals in a square of the grid.
    """

    frames: NDArray[np.float64]
    stretch: float
    grid: int
    limit: float
    least: float
    slope: float
    density: float


class Strip(NamedTuple):
    """Work arrays: `rows` of STEP numbers, and the `faces` inside which cones are, or −1.

    `near` holds the coefficients of the cells and of those around them.
    """

    rows: NDArray[np.float64]
    faces: NDArray[np.int64]
    near: NDArray[np.float64]

    @classmethod
    def new(cls) -> Strip:
        """Return new work arrays."""
        return cls(np.zeros(ROWS * STEP), np.zeros(STEP, np.int64), np.zeros(9 * STEP))


@loop
def strip_of(spline, number, last, strip):
    """Load the strip of cells that begins with a patch; return its first patch and its end.

    The end is at most `last`, rounded up to whole cells. Boxes on faces are left out.
    """
    columns = spline.mu.shape[1] - 2
    i, j, turn = place_of(number, columns)
    count = min(CELLS, columns - j, (last - (number - turn) + 3) // 4)
    load_strip(spline, i, j, count, strip)
    return number - turn, number - turn + 4 * count


@loop
def load_strip(spline, i, j, count, strip):
    """Write the patches of the cells (i, j), …, (i, j + count − 1), at most CELLS, and cones."""
    mu, scale, noise, _ = spline
    write_noise(spline, i, j, count, strip.rows)
    write_vectors(mu, scale, i, j, count, strip.near, strip.rows)
    write_cones(noise, strip.rows)


@loop
def boxes_of(polyhedron, strip):
    """Write the faces of a polyhedron in which the patches of a strip are, and boxes there."""
    write_nearest(polyhedron.frames, strip.rows, strip.faces)
    write_boxes(polyhedron, strip.rows, strip.faces)


@loop
def write_noise(spline, i, j, count, rows):
    """Write the rounding of coordinates for patches on an open side of the domain, 0 for others."""
    mu, _, noise, border = spline
    for k in range(TILE):
        rows[NOISE + k] = 0.0
    for k in range(count):
        if i == mu.shape[0] - 3 and border[1]:
            rows[NOISE + 4 * k + 1] = noise
        if i == 0 and border[3]:
            rows[NOISE + 4 * k + 3] = noise
    if j == 0 and border[0]:
        rows[NOISE] = noise
    if j + count == mu.shape[1] - 2 and border[2]:
        rows[NOISE + 4 * count - 2] = noise


@loop
def write_vectors(mu, scale, i, j, count, near, rows):
    """Write the vectors of patches, and the largest differences of coefficients."""
    for p in range(3):
        for q in range(count + 2):
            put(near, p * ONE_VECTOR, q, vector_at(mu, i + p, j + q))
    west, middle, east = near, near[ONE_VECTOR:], near[2 * ONE_VECTOR :]
    for k in range(CELLS):
        c = vector_in(middle, ZERO, k + 1)
        sw, s, se = (
            step_to(c, scale, west, k),
            step_to(c, scale, middle, k),
            step_to(c, scale, east, k),
        )
        w, e = step_to(c, scale, west, k + 1), step_to(c, scale, east, k + 1)
        nw, n, ne = (
            step_to(c, scale, west, k + 2),
            step_to(c, scale, middle, k + 2),
            step_to(c, scale, east, k + 2),
        )
        spread = Vector(
            max(abs(sw.x), abs(s.x), abs(se.x), abs(w.x), abs(e.x), abs(nw.x), abs(n.x), abs(ne.x)),
            max(abs(sw.y), abs(s.y), abs(se.y), abs(w.y), abs(e.y), abs(nw.y), abs(n.y), abs(ne.y)),
            max(abs(sw.z), abs(s.z), abs(se.z), abs(w.z), abs(e.z), abs(nw.z), abs(n.z), abs(ne.z)),
        )
        put_patch(rows, 4 * k, triangle(sw, s, se, w, e, n), spread)
        put_patch(rows, 4 * k + 1, triangle(se, e, ne, s, n, w), spread)
        put_patch(rows, 4 * k + 2, triangle(ne, n, nw, e, w, s), spread)
        put_patch(rows, 4 * k + 3, triangle(nw, w, sw, n, s, e), spread)


@inline
def step_to(centre, scale, rows, k):
    """Return coefficient k minus that of the cell, times `scale`."""
    v = vector_in(rows, ZERO, k)
    return Vector(scale * (v.x - centre.x), scale * (v.y - centre.y), scale * (v.z - centre.z))


@inline
def put_patch(rows, k, patch, spread):
    """Write the vectors of patch k, and the largest differences of its coefficients."""
    put(rows, VECTORS, k, patch.a)
    put(rows, VECTORS + ONE_VECTOR, k, patch.b)
    put(rows, VECTORS + 2 * ONE_VECTOR, k, patch.c)
    put(rows, VECTORS + 3 * ONE_VECTOR, k, patch.d)
    put(rows, VECTORS + 4 * ONE_VECTOR, k, patch.e)
    put(rows, SPREAD, k, spread)


@loop
def patch_in(rows, k) -> Patch:
    """Return the vectors of patch k, times SCALE * scale, but for p."""
    return Patch(
        vector_in(rows, VECTORS, k),
        vector_in(rows, VECTORS + ONE_VECTOR, k),
        vector_in(rows, VECTORS + 2 * ONE_VECTOR, k),
        vector_in(rows, VECTORS + 3 * ONE_VECTOR, k),
        vector_in(rows, VECTORS + 4 * ONE_VECTOR, k),
        Vector(0.0, 0.0, 0.0),
    )


@loop
def write_cones(noise, rows):
    """Write the directions of control normals, and cones that hold all normals of a patch.

    The errors of directions are angles; they are infinite at a singular point. The cone has an axis
    and the sine of the angle to any normal. The sine is infinite if the cone is not narrow. Also
    written are the bound of the rounding error of U, V, W of the patch, and whether it may be
    developable.
    """
    for k in range(TILE):
        patch = patch_in(rows, k)
        net = control_normals(patch)
        tangents = tangent_bounds(patch)
        square = max(tangents.x, tangents.y, tangents.z)
        square = square * square
        worst = longest = x = y = z = 0.0
        for m in range(6):
            n = net[m]
            size = length(n)
            longest = size if size > longest else longest
            regular = size > SHORT_CONTROL_NORMAL * square
            inverse = 1.0 / size if regular else 0.0
            error = ANGLE_ERROR * (1.0 + square * inverse) if regular else math.inf
            worst = error if error > worst else worst
            n = Vector(n.x * inverse, n.y * inverse, n.z * inverse)
            x, y, z = x + n.x, y + n.y, z + n.z
            put(rows, UNIT + m * ONE_VECTOR, k, n)
            rows[ERRORS + m * STEP + k] = error
        inverse = 1.0 / length(Vector(x, y, z)) if worst < math.inf else 0.0
        r = Vector(x * inverse, y * inverse, z * inverse)
        put(rows, AXIS, k, r)
        cosine, widest = 1.0, 0.0
        for m in range(6):
            n = vector_in(rows, UNIT + m * ONE_VECTOR, k)
            towards, apart = dot(n, r), square_of_sine(n, r)
            cosine = towards if towards < cosine else cosine
            widest = apart if apart > widest else widest
        narrow = (worst < math.inf) & (cosine >= NARROW)
        sine = math.sqrt(widest) + 2.0 * worst if narrow else math.inf
        rows[SINE + k] = sine
        rows[BOUND + k] = bound_of_forms(rows, k, tangents, r, sine)
        rows[FLAT + k] = may_be_developable(patch, longest, noise)


@inline
def square_of_sine(n, r):
    """Return the squared sine of the angle between unit vectors."""
    s = n.y * r.z - n.z * r.y
    t = n.z * r.x - n.x * r.z
    w = n.x * r.y - n.y * r.x
    return s * s + t * t + w * w


@inline
def bound_of_forms(rows, k, tangents, axis, sine):
    """Return a bound of the rounding error of U, V, W of a patch, in its cone of normals."""
    spread = vector_in(rows, SPREAD, k)
    narrow = sine < math.inf
    x = abs(axis.x) + sine if narrow else 1.0  # upper bounds of the components of normals
    y = abs(axis.y) + sine if narrow else 1.0
    z = abs(axis.z) + sine if narrow else 1.0
    form = x * tangents.x + y * tangents.y + z * tangents.z
    error = FORM_ERROR * (x * spread.x + y * spread.y + z * spread.z) + rows[NOISE + k]
    return 32.0 * error * (form + error)


@loop
def write_nearest(frames, rows, faces):
    """Write the faces nearest to the axes of cones."""
    for k in range(TILE):
        rows[BOX + k] = -math.inf
        faces[k] = 0
    for face in range(frames.shape[0]):
        x, y, z = frames[face, 2, 0], frames[face, 2, 1], frames[face, 2, 2]
        for k in range(TILE):
            r = vector_in(rows, AXIS, k)
            height = x * r.x + y * r.y + z * r.z
            higher = height > rows[BOX + k]
            rows[BOX + k] = height if higher else rows[BOX + k]
            faces[k] = face if higher else faces[k]
    for k in range(TILE):
        for x in range(3):
            for y in range(3):
                rows[FRAME + (3 * x + y) * STEP + k] = frames[faces[k], x, y]


@loop
def write_boxes(polyhedron, rows, faces):
    """Write the boxes on the nearest faces; the face becomes −1 if the cone is not inside."""
    _, stretch, grid, limit, _, _, _ = polyhedron
    half = 0.5 * grid
    for k in range(TILE):
        f = vector_in(rows, FRAME, k)
        g = vector_in(rows, FRAME + ONE_VECTOR, k)
        h = vector_in(rows, FRAME + 2 * ONE_VECTOR, k)
        inside = rows[SINE + k] < math.inf
        west = south = least = math.inf
        east = north = most = -math.inf
        error = 0.0
        for m in range(6):
            n = vector_in(rows, UNIT + m * ONE_VECTOR, k)
            angle = rows[ERRORS + m * STEP + k] * stretch
            s, t, height = dot(f, n), dot(g, n), dot(h, n)
            above = height > angle
            inside = inside & above
            inverse, angle = (1.0 / height, angle) if above else (0.0, 0.0)
            away = angle * inverse * (1.0 + (abs(s) + abs(t)) * inverse) * half
            error = away if away > error else error
            s = (s * inverse + 1.0) * half
            t = (t * inverse + 1.0) * half
            west = s if s < west else west
            east = s if s > east else east
            south = t if t < south else south
            north = t if t > north else north
            least = s + t if s + t < least else least
            most = s + t if s + t > most else most
        west, east, south, north = west - error, east + error, south - error, north + error
        least, most = least - 2.0 * error, most + 2.0 * error
        put_box(rows, k, west, east, south, north, least, most)
        inside = inside & (west > 0.0) & (south > 0.0) & (most < limit)
        inside = inside & (east < grid) & (north < grid)
        faces[k] = faces[k] if inside else -1


@inline
def put_box(rows, k, west, east, south, north, least, most):
    """Write the sides of a box."""
    rows[BOX + k] = west
    rows[BOX + STEP + k] = east
    rows[BOX + 2 * STEP + k] = south
    rows[BOX + 3 * STEP + k] = north
    rows[BOX + 4 * STEP + k] = least
    rows[BOX + 5 * STEP + k] = most
