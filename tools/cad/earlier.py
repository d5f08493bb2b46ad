"""Conversion of saved parts of version 1, where edges lie between two faces only, to version 2."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.reading import UnusableError
from .part_arrays import VERSION, differences

__all__ = ["OF_SECOND", "is_of_first", "names_of_first", "of_second"]

Arrays = dict[str, NDArray[Any]]

# The arrays that only version 1 has.
OF_FIRST = ("edge_faces", "edge_points", "edge_point_starts")
OF_SECOND = (
    "vertices", "edge_vertices", "edge_degenerate", "edge_side_starts", "side_faces",
    "side_points", "side_point_starts", "wire_sides", "wire_reversed", "wire_side_starts",
    "face_wires",
)  # fmt: skip


def is_of_first(names: Iterable[str]) -> bool:
    """Return whether the arrays are those of a file of version 1."""
    held = set(names)
    return held.issuperset(OF_FIRST) and not held.intersection(OF_SECOND)


def names_of_first(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the arrays of version 1, from those of version 2."""
    return (*(x for x in names if x not in OF_SECOND), *OF_FIRST)


def of_second(arrays: Arrays) -> Arrays:
    """Return the arrays of version 2: edges with two sides, without vertices, and no wires."""
    faces, points, starts = (arrays[name] for name in OF_FIRST)
    count = len(faces)
    if not (
        faces.dtype == starts.dtype == np.int64
        and points.dtype == np.float64
        and (faces.shape, starts.shape, points.shape[1:]) == ((count, 2), (count + 1,), (4,))
        and (starts[0], starts[-1]) == (0, len(points))
        and (np.diff(starts) >= 0).all()
    ):
        raise UnusableError("is damaged: its edges are not what they should be; save it again.")
    about, sides = json.loads(arrays["about"].tobytes().decode()), []
    if isinstance(about, dict) and about.get("version") == 1:
        about["version"] = VERSION
    for first, last in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        slopes = differences(points[first:last])
        sides += [np.concatenate([x[:, k : k + 2] for x in (points[first:last], slopes)], axis=1)
                  for k in (0, 2)]  # fmt: skip
    counts = np.repeat(np.diff(starts), 2)
    nothing = np.empty(0, dtype=np.int64)
    return {
        **{name: x for name, x in arrays.items() if name not in OF_FIRST},
        "about": np.frombuffer(json.dumps(about).encode(), dtype=np.uint8),
        "vertices": np.empty((0, 3)),
        "edge_vertices": np.full((count, 2), -1),
        "edge_degenerate": np.zeros(count, dtype=np.bool_),
        "edge_side_starts": 2 * np.arange(count + 1),
        "side_faces": faces.ravel(),
        "side_points": np.concatenate([np.empty((0, 4)), *sides]),
        "side_point_starts": np.concatenate([[0], np.cumsum(counts)]),
        "wire_sides": nothing,
        "wire_reversed": np.empty(0, dtype=np.bool_),
        "wire_side_starts": np.zeros(1, dtype=np.int64),
        "face_wires": np.zeros(len(arrays["area"]) + 1, dtype=np.int64),
    }
