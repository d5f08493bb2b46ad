"""Packed runs: hits of one patch whose normals are consecutive points of an icosphere.

A packed run is number of the first normal << 32 | length << SIZE | face << ROW | row. The face is
NO_FACE for a single normal on a border of a face.
"""

from __future__ import annotations

import numpy as np

from ..machine_code.jit import inline, jit, loop
from .classify import UNDECIDED, YES
from .icosphere import ZERO, row_start, write_normals
from .tile import STEP, TILE, fill_tile, load_patch
from .vectors import whole_vectors

__all__ = [
    "LONGEST",
    "MOST_FREQUENT",
    "SIZE",
    "fill_runs",
    "store_border",
    "store_runs",
    "store_undecided",
]

SIZE, ROW = 18, 13
LONGEST, BEFORE_SIZE, BEFORE_ROW = (1 << 32 - SIZE) - 1, (1 << SIZE) - 1, (1 << ROW) - 1
# The highest frequency with rows that fit into the bits.
MOST_FREQUENT = 1 << ROW
# Typed, since Numba compiles a function anew for each literal number in its arguments.
NO_FACE = np.int64(20)
# A patch with at least this many samples begins a tile.
MANY = 32


@inline
def pack_run(face, s, t, count, frequency):
    """Return the packed run of points (s, t), (s, t + 1), … inside a face."""
    row = int(s)
    number = row_start(face, row, frequency) + int(t)
    return number << 32 | count << SIZE | face << ROW | row


@loop
def store_runs(face, frequency, s, t, count, codes, marks, words, ends, patch, certain, at):
    """Write patch and run of points with the code YES to rows from `at` on; return the end.

    Runs begin and end, in turn, where the codes change. `words` (…) is `marks` (…) as groups
    of eight, most of which are zero.
    """
    for k in range(whole_vectors(count)):
        marks[k + 1] = (codes[k] == YES) != (codes[k + 1] == YES)
    size = 0
    for word in range((count >> 3) + 1):
        if words[word] != 0:
            for k in range(8 * word, 8 * word + 8):
                ends[size] = k
                size += marks[k] & (k <= count)
    for k in range(size >> 1):
        start, end = ends[2 * k], ends[2 * k + 1]
        certain[at + k, 0] = patch
        certain[at + k, 1] = pack_run(face, s[start], t[start], end - start, frequency)
    return at + (size >> 1)


@loop
def store_undecided(face, frequency, s, t, count, codes, patch, undecided, at):
    """Write patch and run of each undecided point to rows from `at` on; return the end."""
    for k in range(count):
        if codes[k] == UNDECIDED:
            undecided[at, 0] = patch
            undecided[at, 1] = pack_run(face, s[k], t[k], 1, frequency)
            at += 1
    return at


@loop
def store_border(codes, numbers, count, patch, certain, undecided, counts):
    """Write patch and run of single normals with the code YES, and of undecided ones."""
    for k in range(count):
        run = numbers[k] << 32 | 1 << SIZE | NO_FACE << ROW
        if codes[k] == YES:
            certain[counts[0], 0] = patch
            certain[counts[0], 1] = run
            counts[0] += 1
        elif codes[k] == UNDECIDED:
            undecided[counts[1], 0] = patch
            undecided[counts[1], 1] = run
            counts[1] += 1


# --- the fields of their samples ------------------------------------------------------------------


@jit
def fill_runs(
    mu, scale, normals, frame, frequency, runs, start, tile, indices, places,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill the samples of runs (k, 2), from number `start` on; see `fill_samples`.

    `places` (2 STEP,) is a work array for the rows and columns of the normals.
    """
    at = known = first = ZERO
    face = NO_FACE  # of the samples in the tile without normals yet
    while first < runs.shape[0]:
        patch = runs[first, 0]
        last, total = first, 0
        while last < runs.shape[0] and runs[last, 0] == patch:
            total += runs[last, 1] >> SIZE & LONGEST
            last += 1
        if at > 0 and (total >= MANY or at + total > TILE):
            finish(
                face, frequency, places, known, at, tile, indices, start, scale, frame,
                points, directions, uv, support, gaussian, mean, normal_index, patch_index,
            )  # fmt: skip
            start += at
            at = known = ZERO
        load_patch(mu, patch, scale, tile, at, TILE if total >= MANY else at + total)
        for k in range(first, last):
            run = runs[k, 1]
            number, left, row = run >> 32, run >> SIZE & LONGEST, run & BEFORE_ROW
            if (run & BEFORE_SIZE) >> ROW != face:
                write_normals(face % NO_FACE, frequency, places, known, at - known, tile)
                known = at
                face = (run & BEFORE_SIZE) >> ROW
            while left > 0:
                size = min(left, TILE - at)
                column = number - row_start(face, row, frequency)
                write_run(patch, number, row, column, at, size, indices, places)
                if face == NO_FACE:
                    for x in range(3):
                        tile[x * STEP + at] = normals[number, x]
                    known += 1
                at, number, left = at + size, number + size, left - size
                if at == TILE:
                    finish(
                        face, frequency, places, known, at, tile, indices, start, scale, frame,
                        points, directions, uv, support, gaussian, mean, normal_index, patch_index,
                    )  # fmt: skip
                    start += at
                    at = known = ZERO
        first = last
    finish(
        face, frequency, places, known, at, tile, indices, start, scale, frame,
        points, directions, uv, support, gaussian, mean, normal_index, patch_index,
    )  # fmt: skip


@loop
def finish(
    face, frequency, places, known, at, tile, indices, start, scale, frame,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Write the normals of a tile from number `known` on, and fill its samples."""
    write_normals(face % NO_FACE, frequency, places, known, at - known, tile)
    fill_tile(
        tile, indices, at, start, scale, frame,
        points, directions, uv, support, gaussian, mean, normal_index, patch_index,
    )  # fmt: skip


@inline
def write_run(patch, number, row, column, at, count, indices, places):
    """Write the indices of a run of samples, and the rows and columns, from `at` on."""
    for k in range(count):
        here, beyond = np.uint64(at + k), np.uint64(at + STEP + k)
        indices[here] = number + k
        indices[beyond] = patch
        places[here] = row
        places[beyond] = column + k
