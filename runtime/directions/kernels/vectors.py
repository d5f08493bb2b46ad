"""Vectors in arrays, and basic vector algebra."""

from __future__ import annotations

import math

from ....generated.vectors import Vector
from ...machine_code.jit import inline, loop

# The largest number of lanes of a vectorized loop; arrays are padded by as many entries.
VECTOR = 16
# A tile has TILE samples. Its rows have the length STEP, with room for VECTOR more samples.
TILE = 64
STEP = TILE + VECTOR


@inline
def whole_vectors(count):
    """Return the next multiple of VECTOR, for vectorized loops without a remainder."""
    return (count + (VECTOR - 1)) & -VECTOR


@inline
def row_vector(array, k):
    """Return row k of an array (…, 3)."""
    return Vector(array[k, 0], array[k, 1], array[k, 2])


@inline
def set_row(array, k, v):
    """Write a vector to row k of an array (…, 3)."""
    array[k, 0] = v.x
    array[k, 1] = v.y
    array[k, 2] = v.z


@inline
def set_jet(array, x, x_u, x_v, x_uu, x_uv, x_vv):
    """Write a 2-jet to an array (6, 3)."""
    set_row(array, 0, x)
    set_row(array, 1, x_u)
    set_row(array, 2, x_v)
    set_row(array, 3, x_uu)
    set_row(array, 4, x_uv)
    set_row(array, 5, x_vv)


@inline
def dot(v, w):
    """Return the scalar product of two vectors."""
    return v.x * w.x + v.y * w.y + v.z * w.z


@loop
def length(v):
    """Return the length of a vector."""
    return math.sqrt(v.x * v.x + v.y * v.y + v.z * v.z)


@loop
def largest_component(v):
    """Return the largest modulus of the components of a vector."""
    return max(abs(v.x), abs(v.y), abs(v.z))
