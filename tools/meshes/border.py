"""The boundary of a trimmed surface: polylines in the domain, scaled to the unit square."""

from collections.abc import Iterator, Sequence

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.domain.domain import Boundary, closes
from ...runtime.domain.trim import TrimPart, polygons_of
from ...runtime.spline.missing import Known
from ...runtime.spline.spline import Spline
from ..gauss_map.chains import Segment, chained
from ..gauss_map.polylines import dense
from ..gauss_map.sign_changes import sign_changes
from .places import ON_SIDE, uv_at, wrapped

# The number of steps, per cell, into which polylines are cut.
STEPS_A_CELL = 8
# The trim is tested on both sides of a segment, at this distance from its midpoint, in the unit
# square.
ASIDE = 1e-7
# The boundary of a predicate is searched on a grid with NODES_A_CELL nodes per cell, but at least
# FEWEST and at most MOST nodes along each parameter, and then by bisection. Then, PASSES times, a
# point of the boundary is inserted near the midpoint of each segment, while a polyline has at most
# MOST_POINTS points.
NODES_A_CELL, FEWEST, MOST, BISECTIONS, PASSES = 4, 64, 1024, 40, 5
MOST_POINTS = 50_000


def border_lines(spline: Spline) -> list[Array]:
    """Return polylines (k, 2) that bound the part of a spline inside its trim.

    Boundaries on open sides of the domain are left out. Closed polylines repeat their first point.
    Polylines across seams may run beyond the unit square.
    """
    assert spline.trim is not None
    lines = []
    for part in spline.trim.parts:
        others = [x for x in spline.trim.parts if x is not part]
        for line in _lines(part, spline):
            fine = dense(line, 1.0 / (STEPS_A_CELL * np.array(spline.cells)))
            fine = _with_crossings(fine, spline.boundary)
            lines += _pieces(fine, _is_border(fine, part, others, spline))
    return lines


def _uv(positions: Array, spline: Spline) -> Array:
    return uv_at(spline, wrapped(positions, spline.boundary))


def _lines(part: TrimPart, spline: Spline) -> list[Array]:
    """Return the polylines on which one condition of the trim changes.

    The other conditions are ignored.
    """
    low, high = np.array(spline.domain).T
    if polygons := polygons_of(part):
        closed = [np.concatenate([x, x[:1]]) for x in polygons]
        return [(x - low) / (high - low) for x in closed]
    if isinstance(part, Known):
        segments = list(_edges_of_known(part, spline.boundary))
        chains = chained([x[:2] for x in segments])
        lines = [[segments[k][2][:: -1 if back else 1] for k, back in chain] for chain, _ in chains]
        return [_continued(x, spline.boundary) for x in lines]
    return [_refined(line, part, spline) for line in _changes(part, spline)]


def _with_crossings(line: Array, boundary: Boundary) -> Array:
    """Insert the points, exactly on open sides of the domain, where a polyline crosses them."""
    for axis, ends in enumerate(boundary):
        if closes(ends):
            continue
        for side in (0.0, 1.0):
            line[np.abs(line[:, axis] - side) <= ON_SIDE, axis] = side
            before, after = line[:-1, axis] - side, line[1:, axis] - side
            at = np.flatnonzero(before * after < 0.0)
            share = (before[at] / (before[at] - after[at]))[:, None]
            crossings = line[at] + share * (line[at + 1] - line[at])
            crossings[:, axis] = side
            line = np.insert(line, at + 1, crossings, axis=0)
    return line


def _is_border(line: Array, part: TrimPart, others: list[TrimPart], spline: Spline) -> Flags:
    """Return whether segments of a polyline bound the trimmed surface inside the domain.

    The condition `part` changes across such a segment; the other conditions hold on at least one of
    its sides.
    """
    middles, along = (line[1:] + line[:-1]) / 2.0, np.diff(line, axis=0)
    lengths = np.linalg.norm(along, axis=1)
    aside = np.stack([-along[:, 1], along[:, 0]], axis=1)
    aside *= (ASIDE / np.where(lengths > 0.0, lengths, 1.0))[:, None]
    found = lengths > 0.0
    for axis, ends in enumerate(spline.boundary):
        if not closes(ends):
            found &= (middles[:, axis] > ON_SIDE) & (middles[:, axis] < 1.0 - ON_SIDE)
    places = middles + aside, middles - aside
    if polygons_of(part):
        left, right = (part.contains(_uv(x, spline)) for x in places)
        found &= left != right
    for other in others:
        left, right = (other.contains(_uv(x, spline)) for x in places)
        found &= left | right
    return found


def _pieces(line: Array, kept: Flags) -> list[Array]:
    """Return the parts of a polyline that consist of consecutive kept segments."""
    if kept.all():
        return [line]
    if (line[0] == line[-1]).all():
        start = int(np.argmin(kept))  # a closed line begins at a gap
        line = np.concatenate([line[start:-1], line[: start + 1]])
        kept = np.roll(kept, -start)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
    return [line[first : last + 1] for first, last in edges.reshape(-1, 2)]


# --- missing points of a grid ---------------------------------------------------------------------


def _edges_of_known(part: Known, boundary: Boundary) -> Iterator[Segment]:
    """Yield the edges between patches that depend on missing points and patches that do not."""
    m, n = part.cells
    known = part.patches.reshape(m, n, 4)

    def place(i: float, j: float) -> tuple[float, ...]:
        at = wrapped(np.array([i / m, j / n]), boundary)
        return tuple(np.rint(at * (2 * m, 2 * n)).tolist())

    def segment(*ends: tuple[float, float]) -> Segment:
        return place(*ends[0]), place(*ends[1]), np.array(ends) / (m, n)

    # The patches of a cell are counted counterclockwise from the south; (di, dj) is the corner of
    # the cell between patch `turn` and the next one.
    for turn, (di, dj) in enumerate([(1, 0), (1, 1), (0, 1), (0, 0)]):
        for i, j in np.argwhere(known[..., turn] != known[..., (turn + 1) % 4]).tolist():
            yield segment((i + 0.5, j + 0.5), (i + di, j + dj))
    for axis, first, second in ((0, 1, 3), (1, 2, 0)):
        following = np.roll(known[..., second], -1, axis=axis)
        if boundary[axis][0] == "mirrored":
            last = (-1, slice(None)) if axis == 0 else (slice(None), -1)
            following[last] = following[last][::-1]
        differs = known[..., first] != following
        if not closes(boundary[axis]):
            differs[(-1, slice(None)) if axis == 0 else (slice(None), -1)] = False
        for i, j in np.argwhere(differs).tolist():
            yield segment(
                *([(i + 1, j), (i + 1, j + 1)] if axis == 0 else [(i, j + 1), (i + 1, j + 1)])
            )


# --- predicates -----------------------------------------------------------------------------------


def _changes(part: TrimPart, spline: Spline) -> list[Array]:
    """Return the polylines on which a condition changes: between nodes of a grid, by bisection."""
    counts = np.clip(NODES_A_CELL * np.array(spline.cells), FEWEST, MOST)
    (in_u, _), (in_v, _) = spline.boundary
    nodes = np.moveaxis(np.indices(tuple((counts + 1).tolist())), 0, -1) / counts
    inside = part.contains(_uv(nodes.reshape(-1, 2), spline)).reshape(nodes.shape[:2])
    for axis, kind in enumerate((in_u, in_v)):
        rows = np.swapaxes(inside, 0, axis)
        if closes((kind,)):
            rows[-1] = rows[0, :: -1 if kind == "mirrored" else 1]

    def places(low: Indices, high: Indices) -> Array:
        return _bisected(low / counts, high / counts, inside[tuple(low.T)], part, spline)

    lines = sign_changes(np.where(inside, 1.0, -1.0), (in_u, in_v), places)
    found = [_distinct(_continued(parts, spline.boundary)) for parts, _ in lines]
    return [x for x in found if len(x) > 1]


def _distinct(line: Array) -> Array:
    """Return a polyline (k, 2) without points that nearly repeat the one before, as at a node."""
    found = line[np.append(True, (np.abs(np.diff(line, axis=0)) > ON_SIDE).any(axis=1))]
    found[-1] = line[-1]
    return found


def _continued(parts: Sequence[Array], boundary: Boundary) -> Array:
    """Join polylines (k, 2), each shifted across seams to the end of the previous one."""
    line = [parts[0]]
    for part in parts[1:]:
        line.append(wrapped(part, boundary, line[-1][-1], together=True)[1:])
    return np.concatenate(line)


def _refined(line: Array, part: TrimPart, spline: Spline) -> Array:
    """Insert points of the boundary near the midpoints of the segments of a polyline."""
    for _ in range(PASSES):
        if len(line) > MOST_POINTS:
            break
        middles, along = (line[1:] + line[:-1]) / 2.0, np.diff(line, axis=0)
        aside = np.stack([-along[:, 1], along[:, 0]], axis=1) / 2.0
        low, high = middles - aside, middles + aside
        for axis, ends in enumerate(spline.boundary):
            if not closes(ends):
                low[:, axis], high[:, axis] = (np.clip(x[:, axis], 0.0, 1.0) for x in (low, high))
        left, right = (part.contains(_uv(x, spline)) for x in (low, high))
        here = left != right
        middles[here] = _bisected(low[here], high[here], left[here], part, spline)
        line = np.insert(line, np.arange(1, len(line)), middles, axis=0)
    return line


def _bisected(low: Array, high: Array, at_low: Flags, part: TrimPart, spline: Spline) -> Array:
    """Return positions between `low` and `high` (k, 2) at which a condition changes, by bisection.

    `at_low` (k,) are the values of the condition at `low`.
    """
    low, high = low.copy(), high.copy()
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        same = part.contains(_uv(middle, spline)) == at_low
        low[same], high[~same] = middle[same], middle[~same]
    return (low + high) / 2.0
