"""Points with given normals on edges where faces meet smoothly: one face keeps each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...runtime.base.aliases import Indices
from ...runtime.base.kept import kept
from ..density.at_normals import Given
from .part import Part
from .results import PartSpace

__all__ = ["each_once"]

# Points with the same normal on connected faces are equal if closer than this, relative to the
# size of the part. Near a smooth edge no two points have the same normal and curvatures of the same
# sign.
SAME = 1e-8
# Coordinates along this direction sort points; on symmetric parts, few are equal.
DIRECTION = np.array([0.52, 0.47, 0.71])


def each_once(space: PartSpace, given: Given) -> Given:
    """Return points at normals without those that a face of lower index has, too.

    Where K changes its sign at the edge both are kept: nearby normals have two points or none.
    """
    part = space.pieces[0].face.part
    if len(space.pieces) < 2 or len(given) < 2 or not given.same_normals:
        return given
    points = given.array("points", np.float64)
    faces = np.array([x.face.index for x in space.pieces])[given.pieces]
    is_negative = np.signbit(given.array("gaussian_curvature", np.float64))
    normals = given.array("normal_index", np.int64)
    keys = np.stack([normals, kept(part, each_once, lambda: _connected(part))[faces], is_negative])
    along, slack = points @ DIRECTION, SAME * space.size / space.unit
    order = np.lexsort((along, *keys))
    points, faces, keys, along = points[order], faces[order], keys[:, order], along[order]
    lost = np.zeros(len(order), dtype=np.bool_)
    for step in range(1, len(order)):
        near = (keys[:, step:] == keys[:, :-step]).all(axis=0)
        near &= along[step:] - along[:-step] <= slack
        if not near.any():
            break
        first, second = faces[:-step], faces[step:]
        near &= (np.linalg.norm(points[step:] - points[:-step], axis=1) <= slack) & (
            first != second
        )
        lost[step:] |= near & (first < second)
        lost[:-step] |= near & (first > second)
    keep = np.ones(len(order), dtype=np.bool_)
    keep[order[lost]] = False
    ends = np.cumsum([len(x.samples) for x in given.found])[:-1]
    parts = np.split(keep, ends) if given.found else ()
    found = (x._replace(samples=x.samples[y]) for x, y in zip(given.found, parts, strict=True))
    return replace(given, found=tuple(found)) if lost.any() else given


def _connected(part: Part) -> Indices:
    """Return numbers (F,) that are equal for connected faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    arrays = part.arrays
    starts, faces = arrays["edge_side_starts"], arrays["side_faces"]
    first = faces[np.repeat(starts[:-1], np.diff(starts))]
    links = coo_array((np.ones(len(faces)), (first, faces)), (len(part), len(part)))
    return connected_components(links, directed=False)[1].astype(np.int64)
