"""Joints of quadratic patches: edges that two patches share, and the angles between normals."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags, Indices
from ..base.errors import InputError
from ..base.trees import tree_of


class Edge(NamedTuple):
    """An edge and the control points beside it, as indices in b200, b020, b002, b110, b101, b011.

    The edge has the control points `start`, `middle`, `end`. The vectors from `start` to
    `start_beside`, and from `middle` to `end_beside`, point inwards.
    """

    start: int
    middle: int
    end: int
    start_beside: int
    end_beside: int


# The edges u = 0, v = 0, w = 0, counterclockwise.
EDGES = (Edge(1, 5, 2, 3, 4), Edge(2, 4, 0, 5, 3), Edge(0, 3, 1, 4, 5))
# The indices of the control normals at corners, and along edges from start to end. Control normals
# are in the order N200, N110, N101, N020, N011, N002.
CORNER_NORMALS = (0, 3, 5)
EDGE_NORMALS = ((3, 4, 5), (5, 2, 0), (0, 1, 3))
# Parameters of an edge at which the normals of its patches are compared.
PLACES = np.linspace(0.0, 1.0, 9)
# Points that are closer than this, relative to the largest coordinate, count as the same point.
SAME_POINT = 2.0**-36
# To find the point of an edge that is nearest to a corner, TRIED points of the edge are compared,
# and STEPS steps of Newton's method improve the nearest one.
TRIED, STEPS = 33, 4


class Joints(NamedTuple):
    """The J joints of a spline of nets: curves that are edges of two patches.

    Attributes
    ----------
    patches : (J, 2) int64 array
        The two patches.
    edges : (J, 2) int64 array
        Their edges: 0, 1, 2 for u = 0, v = 0, w = 1 − u − v = 0.
    angles : (J,) float64 array
        The largest angle between the normals of the two patches, in degrees.
    smooth : (J,) bool array
        Whether the normals are continuous; otherwise the joint is a crease.

    Examples
    --------
    >>> import gaussmap as gm
    >>> joints = gm.Spline.from_nets(gm.fit("torus", (4, 4)).control_nets).joints
    >>> len(joints.patches), bool(joints.angles.max() < 1e-5), bool(joints.smooth.all())
    (96, True, True)

    """

    patches: NDArray[np.int64]
    edges: NDArray[np.int64]
    angles: NDArray[np.float64]
    smooth: NDArray[np.bool_]


def merged_points(points: Array) -> tuple[Array, Indices]:
    """Merge points (N, 3) that are equal up to rounding.

    Returns the distinct points, and for each point the index (N,) of its distinct point.
    """
    size = float(np.abs(points).max()) * SAME_POINT
    number = np.arange(len(points))
    if size == 0.0:
        return points[:1], np.zeros_like(number)
    # Two points closer than half a box share a box in one of eight shifted rasters.
    for shift in product((0.0, 0.5), repeat=3):
        boxes = np.floor(points / (2.0 * size) + shift)
        _, group = np.unique(boxes, axis=0, return_inverse=True)
        group = group.ravel()
        least = np.full(group.max() + 1, len(points))
        np.minimum.at(least, group, number)
        number = least[group]
    number = number[number]
    firsts, inverse = np.unique(number, return_inverse=True)
    return points[firsts], inverse.ravel()


def linked(count: int, one: Indices, other: Indices) -> tuple[int, Indices]:
    """Return the number of connected components of a graph, and the component of each node.

    The nodes are [0, count); edge i joins one[i] and other[i]. Components are numbered by their
    first nodes.
    """
    from scipy.sparse import coo_array  # imported late: most splines have a grid
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(one)), (one, other)), shape=(count, count))
    number, group = connected_components(links, directed=False)
    return number, group.astype(np.int64)


@dataclass(frozen=True, eq=False)
class Topology:
    """How the patches of a spline of nets are joined.

    `nets` (T, 6, 3) are the control nets, `numbers` (T, 6) the indices of their points, `normals`
    (T, 6, 3) their control normals. Joints where the normals of both patches differ by at most
    `smooth` degrees are smooth.
    """

    nets: Array
    numbers: Indices
    normals: Array
    smooth: float

    @cached_property
    def _ends(self) -> Indices:
        """The indices of start, end and middle (3 T, 3) of all edges.

        Edge j of patch k is in row 3 k + j.
        """
        rows = [[edge.start, edge.end, edge.middle] for edge in EDGES]
        return self.numbers[:, rows].reshape(-1, 3)

    @cached_property
    def pairs(self) -> Indices:
        """The two edges (J, 2) of each joint; edge j of patch k has the index 3 k + j."""
        start, end, middle = self._ends.T
        keys = np.stack([np.minimum(start, end), np.maximum(start, end), middle], axis=1)
        rows = np.flatnonzero(start != end)  # a collapsed edge is not a joint
        _, group, sizes = np.unique(keys[rows], axis=0, return_inverse=True, return_counts=True)
        group = group.ravel()
        if (sizes > 2).any():
            patches = rows[group == int(np.argmax(sizes > 2))] // 3
            raise InputError(
                f"{len(patches)} patches share one edge, and at most two can: patches "
                f"{', '.join(map(str, patches.tolist()))}."
            )
        order = rows[np.argsort(group, kind="stable")]
        first = (np.cumsum(sizes) - sizes)[sizes == 2]
        pairs = np.stack([order[first], order[first + 1]], axis=1)
        same = start[pairs[:, 0]] == start[pairs[:, 1]]
        if same.any():
            one, other = pairs[np.argmax(same)] // 3
            raise InputError(
                f"patches {one} and {other} have opposite orientations: both run the same way "
                "along their joint; exchange the first two corners of one of them."
            )
        return pairs

    @cached_property
    def joints(self) -> Joints:
        """The joints; InputError if a vertex is inside an edge, or if patches do not fit together.

        More than two patches at one edge do not fit together, nor do opposite orientations.
        """
        pairs = self.pairs
        self._refuse_hanging_vertices()
        left, right = (_normals_along(self.normals, edges) for edges in pairs.T)
        angles = np.degrees(_largest_angles(left, right[:, ::-1]))
        return Joints(pairs // 3, pairs % 3, angles, angles <= self.smooth)

    @cached_property
    def is_point(self) -> Flags:
        """Whether edges (3 T,) are collapsed to a point."""
        return (self._ends[:, :1] == self._ends[:, 1:]).all(axis=1)

    @cached_property
    def smooth_pairs(self) -> Indices:
        """Pairs of edges, as in `pairs`, along which the normals are the same.

        They are the two edges of each smooth joint and, for each patch with a collapsed edge, its
        two other edges.
        """
        rows = np.flatnonzero(self.is_point)
        patch, edge = np.divmod(rows, 3)
        beside = np.stack([3 * patch + (edge + k) % 3 for k in (1, 2)], axis=1)
        beside = beside[~self.is_point[beside].any(axis=1)]
        return np.concatenate([self.pairs[self.joints.smooth], beside])

    @cached_property
    def owner(self) -> tuple[Indices, NDArray[np.int8]]:
        """For each edge (3 T,), the edge that owns its boundary cone, and a sign.

        Both edges of a smooth joint have the same owner, whose cone decides on which side of the
        joint a normal is. The sign is −1 if the quadratic form of the edge (U, V or W) is negative
        where the form of its owner is positive.
        """
        owner, side = np.arange(3 * len(self.nets)), np.ones(3 * len(self.nets), np.int8)
        pairs = self.pairs[self.joints.smooth]
        one, other = np.concatenate([pairs, pairs[:, ::-1]]).T
        while (later := owner[one] < owner[other]).any():
            source, target = one[later], other[later]
            owner[target], side[target] = owner[source], -side[source]
        return owner, side

    @cached_property
    def on_border(self) -> Flags:
        """Whether edges (3 T,) are boundaries or creases: not collapsed, not in `smooth_pairs`."""
        free = ~self.is_point
        free[self.smooth_pairs.ravel()] = False
        return free

    @cached_property
    def corners(self) -> tuple[Array, Indices]:
        """Unit normals at corners, and for each corner of a patch the index (T, 3) of its normal.

        Patches that meet smoothly at a corner share a normal there. A normal is 0 if no patch has a
        normal at the corner.
        """
        pairs = self.smooth_pairs
        # Edge j runs from corner j + 1 to corner j + 2.
        patch, edge = pairs // 3, pairs % 3
        start, end = 3 * patch + (edge + 1) % 3, 3 * patch + (edge + 2) % 3
        one = np.concatenate([start[:, 0], end[:, 0]])
        other = np.concatenate([end[:, 1], start[:, 1]])
        number, fan = linked(3 * len(self.nets), one, other)
        own = _unit(self.normals[:, CORNER_NORMALS].reshape(-1, 3))
        rows = np.flatnonzero(self.is_point)
        own[3 * (rows // 3) + (rows + 1) % 3] = self._normals_at_points(rows)
        shared = np.zeros((number, 3))
        known = np.flatnonzero(own.any(axis=1))[::-1]
        shared[fan[known]] = own[known]
        return shared, fan.reshape(-1, 3)

    @cached_property
    def pole_corner(self) -> Indices:
        """For each patch (T,), the index of its singular corner at a smooth pole, or −1.

        A patch with a collapsed edge has no such corner: its Gaussian image is a curve.
        """
        shared, fan = self.corners
        own = _unit(self.normals[:, CORNER_NORMALS].reshape(-1, 3)).reshape(-1, 3, 3)
        singular = ~own.any(axis=-1) & shared[fan].any(axis=-1)
        singular &= ~self.is_point.reshape(-1, 3).any(axis=-1, keepdims=True)
        return np.where(singular.any(axis=-1), singular.argmax(axis=1), -1)

    @cached_property
    def polar(self) -> tuple[Indices, Indices]:
        """For each edge (3 T,), its end at a smooth pole, and an edge with the same tangent there.

        The end is 0 or 1, and −1 if no end or both ends are at poles. Edges have the same tangent
        at a pole if they form a joint, or meet at a singular corner of a patch. Of all edges that
        have the same tangent, the one with the lowest index is returned.
        """
        shared, fan = self.corners
        row = np.arange(3 * len(self.nets))
        patch, edge = np.divmod(row, 3)
        ends = np.stack([fan[patch, (edge + k) % 3] for k in (1, 2)], axis=1)
        poles = np.isin(ends, ends[self.is_point]) & shared[ends].any(axis=-1)
        known = shared[ends].any(axis=-1).all(axis=-1) & (poles.sum(axis=1) == 1)
        found = np.where(known, poles.argmax(axis=1), -1)
        joined = self.pairs[self.joints.smooth]
        corner = self.pole_corner
        at = np.flatnonzero(corner >= 0)
        beside = np.stack([3 * at + (corner[at] + k) % 3 for k in (1, 2)], axis=1)
        one, other = np.concatenate([joined[found[joined[:, 0]] >= 0], beside]).T
        _, group = linked(len(row), one, other)
        first = np.unique(group, return_index=True)[1]
        return found, first[group]

    def _normals_at_points(self, rows: Indices) -> Array:
        """Return the unit normals (k, 3) of patches at collapsed edges with the indices `rows`."""
        patch, edge = np.divmod(rows, 3)
        beside = np.array([[x.start, x.start_beside, x.end_beside] for x in EDGES])[edge]
        start, first, second = np.moveaxis(self.nets[patch[:, None], beside], 1, 0)
        first, second = first - start, second - start
        size = np.abs([first, second]).max(axis=(0, 2), initial=0.0)[:, None]
        return _unit(np.cross(second, first) / np.where(size > 0.0, size, 1.0) ** 2)

    @cached_property
    def angles(self) -> Array:
        """The largest angle (T,), in radians, between normals of each patch and of its neighbours.

        The normals are compared along smooth joints, and with the shared normals at corners.
        """
        found = np.zeros(len(self.nets))
        joints = self.joints
        for side in (0, 1):
            chosen = joints.patches[joints.smooth, side]
            np.maximum.at(found, chosen, np.radians(joints.angles[joints.smooth]))
        shared, fan = self.corners
        own = self.normals[:, CORNER_NORMALS]
        return np.maximum(found, _largest_angles(own, shared[fan]))

    def _refuse_hanging_vertices(self) -> None:
        joined = np.zeros(3 * len(self.nets), dtype=bool)
        joined[self.pairs.ravel()] = True
        edges = np.flatnonzero(~joined & (self._ends[:, 0] != self._ends[:, 1]))
        if len(edges) == 0:
            return
        ends = self._ends[edges]
        vertices = np.unique(ends[:, :2])
        where = {int(x): self.nets.reshape(-1, 3)[k] for k, x in _firsts(self.numbers)}
        points = np.array([where[int(x)] for x in vertices])
        size = float(np.abs(self.nets).max()) * SAME_POINT
        tree = tree_of(points)
        for edge, (start, end, middle) in zip(edges.tolist(), ends.tolist(), strict=True):
            curve = np.array([where[start], where[middle], where[end]])
            centre = curve.mean(axis=0)
            radius = float(np.linalg.norm(curve - centre, axis=1).max())
            for near in tree.query_ball_point(centre, radius + size):
                if vertices[near] not in (start, end) and _touches(curve, points[near], size):
                    raise InputError(
                        f"a corner of another patch, at {points[near].tolist()}, is inside an edge "
                        f"of patch {edge // 3}: divide this patch there, so that patches meet "
                        "along whole edges."
                    )


def _firsts(numbers: Indices) -> Iterator[tuple[int, int]]:
    """Yield, for each value in `numbers`, its first position in the flat array, and the value."""
    values, places = np.unique(numbers, return_index=True)
    return zip(places.tolist(), values.tolist(), strict=True)


def _touches(curve: Array, point: Array, size: float) -> bool:
    """Return whether the point of a parabolic arc nearest to `point` is within `size` of it.

    If an end of the arc is nearest, the result is False. `curve` (3, 3) are the Bézier points of
    the arc.
    """
    start, middle, end = curve - point
    a, b = start - 2.0 * middle + end, 2.0 * (middle - start)
    t = np.linspace(0.0, 1.0, TRIED)[:, None]
    t = t[np.argmin(np.linalg.norm((a * t + b) * t + start, axis=1)), 0]
    for _ in range(STEPS):
        x, along = (a * t + b) * t + start, 2.0 * a * t + b
        t = min(max(t - float(x @ along) / float(along @ along + 2.0 * (x @ a)), 0.0), 1.0)
    x = (a * t + b) * t + start
    return bool(0.0 < t < 1.0 and np.linalg.norm(x) < size)


def _normals_along(normals: Array, edges: Indices) -> Array:
    """Return normals (J, places, 3) along edges, from control normals (T, 6, 3)."""
    patch, edge = np.divmod(edges, 3)
    control = normals[patch[:, None], np.array(EDGE_NORMALS)[edge]]
    t = PLACES
    return np.einsum("pk,jkx->jpx", np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2], 1), control)


def _largest_angles(left: Array, right: Array) -> Array:
    """Return the largest angle (J,), in radians, between nonzero vectors (J, k, 3)."""
    left, right = _unit(left), _unit(right)
    known = left.any(axis=-1) & right.any(axis=-1)
    chord = np.where(known, np.linalg.norm(left - right, axis=-1), 0.0)
    return (2.0 * np.arcsin(np.clip(0.5 * chord, 0.0, 1.0))).max(axis=-1)


def _unit(vectors: Array) -> Array:
    """Return vectors (…, 3) divided by their lengths; vectors that are rounding errors become 0."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    regular = lengths > SAME_POINT
    return np.where(regular, vectors / np.where(regular, lengths, 1.0), 0.0)
