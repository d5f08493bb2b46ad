"""The fields of samples at the solutions of a search, whose normals are known, from a tape."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.jet import at_jet
from ....generated.vectors import Patch, Vector
from ...directions.kernels.vectors import dot, row_vector, set_row
from ...machine_code.jit import inline, jit, long_vectors, loop
from ...spline.kernels.jets import is_regular
from ...tape.kernels.points import LANES, POINT, UU, UV, VV, U, V, evaluate_points

# The size of a work array: Gaussian and mean curvatures of a tile.
CURVATURES = 2 * LANES
MEAN = np.uint64(LANES)


class SampleFields(NamedTuple):
    """Arrays of fields of samples; those that are not requested are empty."""

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    uv: NDArray[np.float64]
    support: NDArray[np.float64]
    gaussian_curvature: NDArray[np.float64]
    mean_curvature: NDArray[np.float64]
    uv_radius: NDArray[np.float64]


@inline
def derivative(registers, x, y, z, at, factor):
    """Return the vector of the entries x + at, y + at, z + at of `registers`, times a factor.

    It is a derivative of the coordinates, whose registers start at x, y and z.
    """
    return Vector(
        factor * registers[x + at], factor * registers[y + at], factor * registers[z + at]
    )


@loop
def curvatures_of_tile(registers, outputs, scales, count, curvatures):
    """Write K and H of the points of a tile; 0 at singular points. See `evaluate_jets`."""
    long_vectors()
    size, du, dv = scales[0], scales[1], scales[2]
    along_u, along_v = size * du, size * dv
    uu, uv, vv = 2.0 * along_u * du, along_u * dv, 2.0 * along_v * dv
    x, y, z = (
        np.uint64(POINT * outputs[0]), np.uint64(POINT * outputs[1]), np.uint64(POINT * outputs[2])
    )  # fmt: skip
    for k in range(count):
        i = np.uint64(k)
        patch = Patch(
            derivative(registers, x + i, y + i, z + i, UU, uu),
            derivative(registers, x + i, y + i, z + i, UV, uv),
            derivative(registers, x + i, y + i, z + i, VV, vv),
            derivative(registers, x + i, y + i, z + i, U, along_u),
            derivative(registers, x + i, y + i, z + i, V, along_v),
            Vector(0.0, 0.0, 0.0),
        )
        length, _, gaussian, mean = at_jet(patch)
        regular = is_regular(patch, length, gaussian)
        curvatures[i] = gaussian * size * size if regular else 0.0
        curvatures[i + MEAN] = mean * size if regular else 0.0


@jit
def fill_places(tape, work, numbers, places, first, last, normals, scales, curvatures, fields):
    """Write the fields of the samples at the solutions [first, last) of a search.

    places (k, 6) are the solutions, numbers (k,) the indices of their unit normals (S, 3). `scales`
    are (size, du, dv): a rectangle of parameters du × dv, mapped to the surface and multiplied by
    `size`, has about the size 1.
    """
    x, y, z = POINT * tape.outputs[0], POINT * tape.outputs[1], POINT * tape.outputs[2]
    curved = len(fields.gaussian_curvature) + len(fields.mean_curvature) > 0
    evaluated = curved or len(fields.points) + len(fields.support) > 0
    for start in range(first, last, LANES):
        count = min(LANES, last - start)
        for k in range(count):
            work.u[k], work.v[k] = places[start + k, 0], places[start + k, 1]
        if evaluated:
            evaluate_points(tape, work.u, work.v, count, work.registers)
        if curved:
            curvatures_of_tile(work.registers, tape.outputs, scales, count, curvatures)
        for k in range(count):
            at, i = np.uint64(start + k), np.uint64(k)
            n = row_vector(normals, numbers[at])
            if evaluated:
                point = Vector(
                    work.registers[np.uint64(x + k)],
                    work.registers[np.uint64(y + k)],
                    work.registers[np.uint64(z + k)],
                )
                if len(fields.points) > 0:
                    set_row(fields.points, at, point)
                if len(fields.support) > 0:
                    fields.support[at] = dot(point, n)
            if len(fields.normals) > 0:
                set_row(fields.normals, at, n)
            if len(fields.uv) > 0:
                fields.uv[at, 0], fields.uv[at, 1] = work.u[k], work.v[k]
            if len(fields.gaussian_curvature) > 0:
                fields.gaussian_curvature[at] = math.copysign(curvatures[i], places[at, 4])
            if len(fields.mean_curvature) > 0:
                fields.mean_curvature[at] = curvatures[i + MEAN]
            if len(fields.uv_radius) > 0:
                fields.uv_radius[at, 0], fields.uv_radius[at, 1] = places[at, 2], places[at, 3]
