"""The search for all points of a spline with given normals, each found exactly once.

An index lists, for each bin of the sphere, the patches that may have normals in it. Whether a patch
has a normal follows from the signs of its quadratic forms U, V, W and D at this normal (paper,
Sect. 3.2). Exact arithmetic decides the pairs for which rounding leaves a sign open.
"""

from collections.abc import Callable, Generator, Iterator
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags, Indices
from ..base.kept import kept
from ..base.memory import check_memory
from ..base.threads import over_ranges
from ..spline.kernels.patch import count_developable
from ..spline.nets import AnySpline, NetSpline
from ..spline.spline import Spline
from ..spline.tips import tips_of
from .exact import decide
from .hits import Hits, fill
from .in_nets import decide_in_nets, flat_nets
from .kernels.lists import NUMBER, order_few
from .kernels.search import PATCHES, Memory, Pairs, search
from .lines import beside_lines, have_lines, places_at
from .patch_index import MOST_PATCHES, Index, index_of, open_sides, ordered, sorted_keys

# The largest number of normals that are searched together, and of hits that are sorted together.
NORMALS_AT_A_TIME, MOST_HITS = 1 << 20, 1 << 23
# The number of normals that a thread takes at a time, and the initial capacity of its arrays of
# keys.
RANGE, ROOM = 1 << 13, 1 << 15
PATCHES_AT_A_TIME = 1 << 14


def find(
    spline: AnySpline, normals: Array, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return all hits: pairs of one of the unit normals (S, 3) and a patch that has this normal."""
    check_memory("search", len(normals))
    return Hits.joined(list(find_in_turn(spline, normals, threads, progress)))


def find_in_turn(
    spline: AnySpline, normals: Array, threads: int | None = None, progress: bool = False
) -> Iterator[Hits]:
    """Yield hits, one `Hits` for each range of consecutive normals, so that memory is bounded.

    There is at least one range, also if there are no normals.
    """
    yield from _in_turn(spline, normals, _with_lines, threads, progress)


def _in_turn(
    spline: AnySpline,
    normals: Array,
    decided: Callable[..., Hits],
    threads: int | None,
    progress: bool = False,
) -> Iterator[Hits]:
    """Yield the hits as `find_in_turn` does; the function `decided` returns the hits of a range."""
    developable = developable_patches(spline, threads)
    tips = tips_of(spline)
    nothing = developable == spline.patches or (tips is not None and tips.collapsed.all())
    if nothing or len(normals) == 0:
        yield Hits.none(developable)
        return
    first, size = 0, NORMALS_AT_A_TIME
    while first < len(normals):
        part = normals[first : first + size]
        found = _keys(spline, part, threads, progress)
        if found is None:
            size = -(-size // 2)
            continue
        hits = decided(spline, part, *found, developable, threads)
        if first:
            hits.keys[:] += first << 32
        yield hits
        first += size


def _keys(
    spline: AnySpline, normals: Array, threads: int | None, progress: bool
) -> tuple[list[Indices], Indices, Array] | None:
    """Return the keys of certain hits and of undecided pairs, and error bounds for the latter.

    An error bound holds for the forms U, V, W of the patch of a pair. The result is None if several
    normals have more than MOST_HITS hits together.
    """
    certain, undecided, bounds, total = [], [], [], 0
    for first in range(0, spline.patches, MOST_PATCHES):
        index = index_of(spline, threads, first)
        with closing(_ranges(index, normals, threads, progress)) as ranges:
            for sure, open_ in (x for parts in ranges for x in parts):
                bounds.append(index.bounds[open_ & NUMBER])
                certain.append(sure + first if first else sure)
                undecided.append(open_ + first)
                total += len(sure) + len(open_)
                if total > MOST_HITS and len(normals) > 1:
                    return None
    none = np.empty(0, np.int64), np.empty(0)
    return certain, np.concatenate([none[0], *undecided]), np.concatenate([none[1], *bounds])


def _ranges(
    index: Index, normals: Array, threads: int | None, progress: bool
) -> Generator[list[tuple[Indices, Indices]], None, None]:
    """Yield, for each range of sorted normals, arrays of keys of certain and undecided hits."""
    order = ordered(normals, index.lists, threads)

    def work(first: int, last: int) -> list[tuple[Indices, Indices]]:
        memory, found, parts = Memory.new(index.most), Pairs.new(ROOM), []
        while first < last:
            first, needed = search(
                PATCHES, index.pieces, index.lists, normals, order, first, last, memory, found
            )
            certain, undecided = found.counts
            parts.append((found.certain[:certain].copy(), found.undecided[:undecided].copy()))
            if needed > len(found.certain):
                found = Pairs.new(needed)
        return parts

    yield from over_ranges(work, len(order), RANGE, threads, progress)


def _decided(
    spline: AnySpline, normals: Array, certain: list[Indices], undecided: Indices,
    bounds: Array, developable: int, threads: int | None,
) -> Hits:  # fmt: skip
    """Return the certain hits and those of the undecided pairs that exact arithmetic confirms."""
    exact, local = np.empty(0, np.int64), np.empty((0, 5))
    if len(undecided) > 0:
        # Sorting by patches is faster: the vectors of a patch are converted to integers only once.
        patches, numbers = undecided & NUMBER, undecided >> 32
        order = np.lexsort((numbers, patches))
        patches, numbers = patches[order], numbers[order]
        if isinstance(spline, NetSpline):
            decision = decide_in_nets(spline, patches, normals[numbers], numbers)
        else:
            forgiven = np.where(on_border(spline, patches), bounds[order], 0.0)
            decision = decide(spline, patches, normals[numbers], numbers, forgiven, threads)
        decided = undecided[order][decision.which]
        order = np.argsort(decided)
        exact, local = decided[order], decision.local[order]
    # The hits of each normal are in the order of patches, followed by the hits that were decided
    # exactly. `order_few` moves these to their positions.
    keys = sorted_keys([*certain, exact], 32, len(normals))
    if len(exact) > 0:
        order_few(keys)
    exact = np.searchsorted(keys, exact)
    return _without_tips(spline, normals, Hits(keys, exact, local, developable))


def _with_lines(
    spline: AnySpline, normals: Array, certain: list[Indices], undecided: Indices,
    bounds: Array, developable: int, threads: int | None,
) -> Hits:  # fmt: skip
    """Return the hits as `_decided` does, but displace the normals that lines in nets have."""
    numbers, lines = undecided >> 32, np.empty(0, np.int64)
    if isinstance(spline, NetSpline) and len(undecided) > 0:
        lines = np.unique(numbers[have_lines(spline, undecided & NUMBER, normals[numbers])])
    if len(lines) == 0:
        return _decided(spline, normals, certain, undecided, bounds, developable, threads)
    assert isinstance(spline, NetSpline)
    keep = ~np.isin(numbers, lines)
    certain = [x[~np.isin(x >> 32, lines)] for x in certain]
    found = _decided(spline, normals, certain, undecided[keep], bounds[keep], developable, threads)
    beside = beside_lines(spline, normals[lines])
    moved = Hits.joined(list(_in_turn(spline, beside, _decided, threads)))
    (K,) = fill(spline, beside, moved, threads, ("gaussian_curvature",)).values()
    numbers = lines[moved.normal_index]
    uv = places_at(spline, moved.patch_index, normals[numbers], beside[moved.normal_index])
    local = np.column_stack([uv, np.copysign(1.0, K), uv])
    return found.merged(numbers << 32 | moved.patch_index, local)


def _without_tips(spline: AnySpline, normals: Array, hits: Hits) -> Hits:
    """Return the hits without those at a tip, where the surface has no normal."""
    tips = tips_of(spline)
    if tips is None:
        return hits
    near = np.flatnonzero(tips.touching[hits.patch_index])
    part = hits.rows(near)
    points = fill(spline, normals, part, fields=("points",))["points"]
    kept = np.ones(len(hits), np.bool_)
    kept[near[tips.hold(points)]] = False
    return hits if kept.all() else hits.rows(np.flatnonzero(kept))


def developable_patches(spline: AnySpline, threads: int | None) -> int:
    """Return the number of patches that are developable up to the rounding of their coordinates."""
    if isinstance(spline, NetSpline):
        return int(np.count_nonzero(flat_nets(spline)))

    def work(first: int, last: int) -> int:
        return count_developable(spline.coefficients, spline.scale, spline.noise, first, last)

    def count() -> int:
        return sum(over_ranges(work, spline.patches, PATCHES_AT_A_TIME, threads))

    return kept(spline, "developable", count)


def on_border(spline: Spline, patches: NDArray[np.int64]) -> Flags:
    """Return which patches have their outer edge on the open boundary of the domain."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    outermost = np.stack([j == 0, i == spline.cells[0] - 1, j == spline.cells[1] - 1, i == 0])
    return open_sides(spline)[turn] & np.take_along_axis(outermost, turn[None], axis=0)[0]
