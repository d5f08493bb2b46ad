"""Joining pieces of curves in the parameter plane into polylines."""

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ends = tuple[Hashable, Hashable]
# The nodes at both ends of a piece of a polyline, and its vertices (k, 2).
Segment = tuple[Hashable, Hashable, Array]


def chained(pieces: Sequence[Ends]) -> list[tuple[list[tuple[int, bool]], bool]]:
    """Chain pieces, given by the nodes at their ends, into curves.

    A curve continues through a node at which exactly two pieces end. Return a pair for each curve:
    the list of its pieces, and whether it is closed. A piece is given by its index, and whether it
    is reversed.
    """
    at_node: dict[Hashable, list[int]] = {}
    for number, ends in enumerate(pieces):
        for node in ends:
            at_node.setdefault(node, []).append(number)
    unused = dict.fromkeys(range(len(pieces)))

    def walk(number: int, node: Hashable) -> list[tuple[int, bool]]:
        chain = []
        while True:
            del unused[number]
            start, end = pieces[number]
            chain.append((number, start != node))
            node = end if start == node else start
            following = [x for x in at_node[node] if x in unused]
            if len(at_node[node]) != 2 or not following:
                return chain
            number = following[0]

    ends = [(x, node) for node, numbers in at_node.items() if len(numbers) != 2 for x in numbers]
    result = [(walk(number, node), False) for number, node in ends if number in unused]
    while unused:
        number = next(iter(unused))
        result.append((walk(number, pieces[number][0]), True))
    return result


def joined(segments: Sequence[Segment]) -> list[tuple[Array, bool]]:
    """Join segments at common nodes; return polylines (k, 2) and whether each is closed.

    Polylines end where more or fewer than two segments meet. In a periodic direction a node may
    have several positions: each segment is shifted to the end of the previous one, so that a
    polyline may run beyond the domain. A closed polyline repeats its first node at its end.
    """
    result = []
    for chain, closed in chained([segment[:2] for segment in segments]):
        parts = [segments[number][2][:: -1 if turned else 1] for number, turned in chain]
        result.append((continued(parts), closed))
    return result


def continued(parts: Sequence[Array]) -> Array:
    """Join polylines (k, 2), each shifted to the end of the previous one."""
    line = [parts[0]]
    for part in parts[1:]:
        line.append(part[1:] + (line[-1][-1] - part[0]))
    return np.concatenate(line)
