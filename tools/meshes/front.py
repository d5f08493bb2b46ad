"""Front triangles: of the triangles above a point of the xy plane, the one with the largest z."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.repeats import repeated

# The number of pixels along each side for `in_front`, and the number of triangles that it treats at
# a time.
PIXELS, AT_ONCE = 400, 4096
# The number of points that `Front` treats at a time.
POINTS = 1 << 15


@dataclass(frozen=True, eq=False)
class Front:
    """Triangles (T, 3, 3), listed by the squares of a grid in the xy plane.

    The triangles of square k have the indices `owners[starts[k] : starts[k + 1]]`.
    """

    triangles: Array
    low: Array
    step: Array
    grid: int
    owners: Indices
    starts: Indices

    @classmethod
    def of(cls, triangles: Array) -> Front:
        """List triangles in all squares that their bounding boxes meet."""
        flat, grid = triangles[..., :2], max(1, 2 * round(math.sqrt(len(triangles))))
        low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
        step = np.where(high > low, high - low, 1.0) / grid
        first, last = (
            np.clip(np.floor((x - low) / step), 0, grid - 1).astype(np.int64)
            for x in (flat.min(axis=1), flat.max(axis=1))
        )
        sizes = last - first + 1
        owner, k = repeated(sizes.prod(axis=1))
        i, j = np.divmod(k, sizes[owner, 1])
        listed = (first[owner, 0] + i) * grid + first[owner, 1] + j
        order = np.argsort(listed, kind="stable")
        starts = np.searchsorted(listed[order], np.arange(grid * grid + 1))
        return cls(triangles, low, step, grid, owner[order], starts)

    def at(self, places: Array) -> Array:
        """Return z of the front triangle at points (P, 2); −∞ for a point without a triangle."""
        found = np.full(len(places), -np.inf)
        for first in range(0, len(places), POINTS):
            found[first : first + POINTS] = self._at(places[first : first + POINTS])
        return found

    def _at(self, places: Array) -> Array:
        squares = np.clip(np.floor((places - self.low) / self.step), 0, self.grid - 1)
        own = squares.astype(np.int64) @ [self.grid, 1]
        place, k = repeated(self.starts[own + 1] - self.starts[own])
        near = self.triangles[self.owners[self.starts[own][place] + k]]
        inside, depths = _depths(near, places[place])
        found = np.full(len(places), -np.inf)
        np.maximum.at(found, place[inside], depths)
        return found


def in_front(triangles: Array) -> Flags:
    """Return whether triangles (T, 3, 3) are front triangles at the centre of some pixel."""
    flat = triangles[..., :2]
    lowest = flat.min(axis=(0, 1))
    step = (float(np.ptp(flat, axis=(0, 1)).max()) or 1.0) / PIXELS
    flat = (flat - lowest) / step - 0.5  # centres of pixels are whole numbers
    first, last = np.ceil(flat.min(axis=1)), np.floor(flat.max(axis=1))
    sizes = np.maximum(last - first + 1, 0).astype(np.int64)
    depths, owners = np.full((PIXELS + 1) ** 2, -np.inf), np.full((PIXELS + 1) ** 2, -1)
    for start in range(0, len(triangles), AT_ONCE):
        rows = np.arange(start, min(start + AT_ONCE, len(triangles)))
        row, k = repeated(sizes[rows].prod(axis=1))
        row = rows[row]
        pixels = first[row] + np.stack(np.divmod(k, np.maximum(sizes[row, 1], 1)), axis=1)
        scaled = np.concatenate([flat[row], triangles[row][..., 2:]], axis=2)
        inside, found = _depths(scaled, pixels)
        row, pixel = row[inside], pixels[inside].astype(np.int64) @ [PIXELS + 1, 1]
        order = np.argsort(found)
        order = order[found[order] > depths[pixel[order]]]
        depths[pixel[order]], owners[pixel[order]] = found[order], row[order]  # the last one stays
    found = np.zeros(len(triangles), dtype=np.bool_)
    found[owners[owners >= 0]] = True
    return found


def _depths(triangles: Array, places: Array) -> tuple[Flags, Array]:
    """Return whether triangles (k, 3, 3) contain their points (k, 2), in the xy plane.

    Also return z at the points, for the triangles that contain their point.
    """
    a, b, c = np.moveaxis(triangles[..., :2] - places[:, None], 1, 0)
    weights = np.stack([cross_of(b, c), cross_of(c, a), cross_of(a, b)], axis=1)
    total = weights.sum(axis=1, keepdims=True)
    weights /= np.where(total == 0.0, np.nan, total)
    inside = np.all(weights >= -1e-9, axis=1)
    return inside, np.einsum("ij,ij->i", weights, triangles[..., 2])[inside]


def cross_of(left: Array, right: Array) -> Array:
    """Return left_x right_y − left_y right_x (k,) of vectors (k, 2)."""
    return left[:, 0] * right[:, 1] - left[:, 1] * right[:, 0]
