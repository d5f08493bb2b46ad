"""The search for points of an icosphere that are normals of patches, by faces and rows.

The points of a face lie on a lattice in its plane, where the linear forms of a patch are linear in
row and column: only the normals of undecided points are computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.icosahedron import FACES, PHI, POSITIONS
from ...generated.patch import eliminated_forms, linear_forms
from ...generated.vectors import Vector
from ..base.tolerances import ACCURATE, LATTICE_ERROR
from ..machine_code.jit import inline, jit, loop
from .classify import NO, UNDECIDED, YES, classify, count_undecided, look_again
from .few import NO_STARTS, Few, classify_few, store_few_runs
from .icosphere import ONE, ZERO, write_line
from .rows import FaceMemory, border_points, count_points, points_inside
from .runs import store_border, store_runs, store_undecided
from .search import FEW, Coefficients, Found
from .strips import AXIS, BOUND, FLAT, SINE, Polyhedron, Strip, boxes_of, patch_in, strip_of
from .tile import STEP, TILE, vector_in
from .vectors import dot, row_vector, whole_vectors
from .windows import Cone, load_cone

__all__ = ["scan_in"]

# The squared length of the corners of the icosahedron.
SQUARE = 1.0 + PHI * PHI


class LatticeMemory(NamedTuple):
    """Work arrays: the linear forms on a face (3, 6), and a tile of undecided normals."""

    forms: NDArray[np.float64]
    tile: NDArray[np.float64]
    places: NDArray[np.int64]
    codes: NDArray[np.int8]

    @classmethod
    def new(cls) -> LatticeMemory:
        """Return new work arrays."""
        return cls(
            np.empty((3, 6)),
            np.zeros(3 * STEP),
            np.empty(2 * STEP, np.int64),
            np.empty(STEP, np.int8),
        )


class LatticeCandidates(NamedTuple):
    """Work arrays for candidate points: numbers, rows, columns, codes, and changes of codes."""

    numbers: NDArray[np.int64]
    s: NDArray[np.float64]
    t: NDArray[np.float64]
    codes: NDArray[np.int8]
    marks: NDArray[np.int8]
    words: NDArray[np.int64]

    @classmethod
    def new(cls, count: int, frequency: int) -> LatticeCandidates:
        """Return work arrays for `count` points in `frequency` rows."""
        size = count + frequency + 64
        marks = np.zeros((size + 7) // 8 * 8, np.int8)
        # Vectors of rows and columns are read beyond their ends: what is there by chance may be
        # subnormal numbers, which are slow.
        return cls(
            np.empty(size, np.int64),
            np.zeros(size),
            np.zeros(size),
            np.zeros(size, np.int8),
            marks,
            marks.view(np.int64),
        )

    def room(self, frequency: int) -> int:
        """Return the capacity in points."""
        return self.s.size - frequency - 64


def scan_in(
    spline: Coefficients, icosahedron: Polyhedron, normals: NDArray[np.float64]
) -> Callable[[int, int, Found], tuple[int, int]]:
    """Return a function that calls `scan_patches` with work arrays of its own."""
    frequency = icosahedron.grid
    strip, few, cone = Strip.new(), Few.new(), Cone.new()
    faces, memory = FaceMemory.new(frequency), LatticeMemory.new()
    candidates = LatticeCandidates.new(FEW, frequency)

    def scan(first: int, last: int, found: Found) -> tuple[int, int]:
        nonlocal candidates
        while True:
            first, needed = scan_patches(
                spline, icosahedron, normals, first, last, found,
                strip, few, cone, faces, memory, candidates,
            )  # fmt: skip
            if needed <= candidates.room(frequency):
                return first, needed
            candidates = LatticeCandidates.new(2 * needed, frequency)

    return scan


@jit
def scan_patches(
    spline, icosahedron, normals, first_patch, last_patch, found,
    strip, few, cone, faces, memory, candidates,
):  # fmt: skip
    """Find the points of an icosphere that are normals of patches, in ascending order for each.

    As `search_patches`, for the points (S, 3) of frequency ν; the results are packed runs.
    """
    certain, undecided, bounds, flat, counts = found
    frequency = icosahedron.grid
    begin = end = first_patch
    for number in range(first_patch, last_patch):
        if number == end:
            begin, end = strip_of(spline, number, last_patch, strip)
            boxes_of(icosahedron, strip)
            classify_few(icosahedron, NO_STARTS, normals, strip, end - begin, few)
        place = number - begin
        face_count, total, at_border = 0, few.starts[place + 1] - few.starts[place], False
        if few.many[place]:
            load_cone(strip.rows, place, cone)
            face_count, total, at_border = count_points(
                cone, strip.rows[SINE + place], frequency, faces
            )
        if total > 0 and (
            counts[0] + total + 1 > certain.shape[0]
            or counts[1] + total + 1 > undecided.shape[0]
            or total + frequency + 64 > candidates.s.size
        ):
            return number, total + 1
        if strip.rows[FLAT + place] > 0.0:
            flat[counts[2]] = number
            counts[2] += 1
        if total == 0:
            continue
        before = counts[1]
        if few.many[place]:
            search_faces(
                number, face_count, at_border, frequency, normals, found, strip, place,
                faces, memory, candidates,
            )  # fmt: skip
        else:
            store_few_runs(few, place, number, certain, undecided, counts)
        for k in range(before, counts[1]):
            bounds[k] = strip.rows[BOUND + place]
    return last_patch, 0


@loop
def search_faces(
    number, face_count, at_border, frequency, normals, found, strip, place,
    faces, memory, candidates,
):  # fmt: skip
    """Find the points on the faces met by a patch with many candidates, by rows."""
    certain, undecided, _, _, counts = found
    numbers, s, t, codes, marks, words = candidates
    patch, axis = patch_in(strip.rows, place), vector_in(strip.rows, AXIS, place)
    sine, bound = strip.rows[SINE + place], strip.rows[BOUND + place]
    if at_border:
        count = border_points(faces, frequency, numbers)
        classify_border(patch, axis, sine, bound, normals, numbers, count, memory, codes)
        store_border(codes, numbers, count, number, certain, undecided, counts)
    for k in range(face_count):
        face = faces.met[k]
        count = points_inside(face, faces, frequency, s, t)
        forms_on_face(patch, axis, sine, face, frequency, memory.forms)
        largest = bound if sine < math.inf else math.inf
        if classify_points(memory.forms, largest, frequency, s, t, count, codes) > 0:
            classify_again(patch, axis, sine, bound, face, frequency, s, t, count, memory, codes)
            counts[1] = store_undecided(
                face, frequency, s, t, count, codes, number, undecided, counts[1]
            )
        counts[0] = store_runs(
            face, frequency, s, t, count, codes, marks, words, numbers, number, certain, counts[0]
        )


@loop
def forms_on_face(patch, axis, sine, face, frequency, forms):
    """Write the linear forms (3, 6) at the point (0, 0) of a face, and their steps by row, column.

    They are A, B, C, P, Q and the height along the axis, which is 1 without a cone.
    """
    corner = row_vector(POSITIONS, FACES[face, 0])
    for k in range(3):
        n, factor = corner, frequency
        if k > 0:
            other = row_vector(POSITIONS, FACES[face, k])
            n, factor = Vector(other.x - corner.x, other.y - corner.y, other.z - corner.z), 1
        A, B, C, P, Q = linear_forms(patch, n)
        forms[k, 0] = A * factor
        forms[k, 1] = B * factor
        forms[k, 2] = C * factor
        forms[k, 3] = P * factor
        forms[k, 4] = Q * factor
        forms[k, 5] = factor * dot(n, axis)
    if sine == math.inf:
        forms[0, 5], forms[1, 5], forms[2, 5] = 1.0, 0.0, 0.0


@loop
def classify_points(forms, bound, frequency, s, t, count, codes):
    """Write the codes of the points of a face, as `classify`; return the number of undecided ones.

    The normals are not normalized, and the forms have additional errors: certain signs exceed twice
    the bound. Where the column is NaN the code is NO.
    """
    largest = 0.0
    for k in range(5):
        steps = max(abs(forms[1, k]), abs(forms[2, k]))
        largest = max(largest, abs(forms[0, k]) + frequency * steps)
    error = LATTICE_ERROR * largest * largest
    bound = 2.0 * bound * SQUARE * frequency * frequency
    least = ACCURATE * bound + error
    bound += error
    A_0, B_0, C_0, P_0, Q_0, height_0 = row_of_forms(forms, 0)
    A_s, B_s, C_s, P_s, Q_s, height_s = row_of_forms(forms, 1)
    A_t, B_t, C_t, P_t, Q_t, height_t = row_of_forms(forms, 2)
    for k in range(whole_vectors(count + 1)):
        p, q = s[k], t[k]
        A = A_0 + p * A_s + q * A_t
        B = B_0 + p * B_s + q * B_t
        C = C_0 + p * C_s + q * C_t
        P = P_0 + p * P_s + q * P_t
        Q = Q_0 + p * Q_s + q * Q_t
        height = height_0 + p * height_s + q * height_t
        D, U, V, W = eliminated_forms(A, B, C, P, Q)
        low = U if U < V else V
        low = low if low < W else W
        high = U if U > V else V
        high = high if high > W else W
        outside = ((low < -bound) & (high > bound)) | (not (height > 0.0))
        sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
        codes[k] = NO if outside else YES if sure else UNDECIDED
    return count_undecided(codes, count)


@inline
def row_of_forms(forms, k):
    """Return one row of the linear forms on a face."""
    return forms[k, 0], forms[k, 1], forms[k, 2], forms[k, 3], forms[k, 4], forms[k, 5]


@loop
def classify_again(patch, axis, sine, bound, face, frequency, s, t, count, memory, codes):
    """Classify the undecided points of a face by their normals."""
    k = ZERO
    while k < count:
        size = 0
        while codes[k + size] == UNDECIDED and size < TILE:
            size += 1
        if size > 0:
            write_line(
                face, frequency, int(s[k]), int(t[k]), ZERO, ONE, size, memory.places, memory.tile
            )
            classify_tile(patch, axis, sine, bound, memory, codes, k, size)
        k += max(size, 1)


@loop
def classify_border(patch, axis, sine, bound, normals, numbers, count, memory, codes):
    """Write the codes of the normals with the given numbers."""
    for begin in range(0, count, TILE):
        size = min(TILE, count - begin)
        for k in range(size):
            for x in range(3):
                memory.tile[x * STEP + k] = normals[numbers[begin + k], x]
        classify_tile(patch, axis, sine, bound, memory, codes, begin, size)


@loop
def classify_tile(patch, axis, sine, bound, memory, codes, first, size):
    """Write the codes of the normals of a tile from codes[first] on; see `classify`."""
    _, x, _, found = memory
    y, z = x[STEP:], x[2 * STEP :]
    classify(patch, axis, sine, bound, x, y, z, found, whole_vectors(size))
    if sine == math.inf:
        look_again(patch, x, y, z, found, size)
    for k in range(size):
        codes[first + k] = found[k]
