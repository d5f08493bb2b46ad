"""Joining pieces of curves in the parameter plane into polylines."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["Segment", "joined"]

Array = NDArray[np.float64]
# The nodes at both ends of a piece of a polyline, and its vertices (k, 2).
Segment = tuple[Hashable, Hashable, Array]


def joined(segments: Sequence[Segment]) -> list[tuple[Array, bool]]:
    """Join segments at common nodes; return polylines (k, 2) and whether each is closed.

    Polylines end where more or fewer than two segments meet. In a periodic direction a node may
    have several places: each segment is moved to where the one before it ends, so that a polyline
    may run beyond the domain. A closed polyline repeats its first node at its end.
    """
    at_node: dict[Hashable, list[int]] = {}
    for number, (start, end, _) in enumerate(segments):
        at_node.setdefault(start, []).append(number)
        at_node.setdefault(end, []).append(number)
    unused = dict.fromkeys(range(len(segments)))
    ends = [node for node, numbers in at_node.items() if len(numbers) != 2]
    result = []
    for node in ends:
        for number in at_node[node]:
            if number in unused:
                result.append((_walk(segments, at_node, unused, node, number), False))
    while unused:
        number = next(iter(unused))
        result.append((_walk(segments, at_node, unused, segments[number][0], number), True))
    return result


def _walk(
    segments: Sequence[Segment],
    at_node: dict[Hashable, list[int]],
    unused: dict[int, None],
    node: Hashable,
    number: int,
) -> Array:
    """Follow segments from a node on until they end or come back."""
    places: list[Array] = []
    while True:
        del unused[number]
        start, end, ends = segments[number]
        if start != node:
            start, end, ends = end, start, ends[::-1]
        if not places:
            places.append(ends[0])
        places.extend(ends[1:] + (places[-1] - ends[0]))
        node = end
        following = [x for x in at_node[node] if x in unused]
        if len(at_node[node]) != 2 or not following:
            return np.array(places)
        number = following[0]
