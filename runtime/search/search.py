"""The search for all points of a spline with given normals, each found exactly once.

An index lists, for each bin of the sphere, the patches that may have normals in it. Whether a patch
has a normal follows from the signs of its quadratic forms U, V, W and D at this normal (paper,
Sect. 3.2). Exact arithmetic decides the pairs for which rounding leaves a sign open.
"""

from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import replace

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
from .lines import beside_lines, lines_of, meeting, with_components
from .patch_index import MOST_PATCHES, Index, index_of, open_sides, ordered, sorted_keys

# The largest numbers of normals that are searched together, and of hits that are sorted together.
NORMALS_AT_A_TIME, MOST_HITS = 1 << 20, 1 << 23
# The number of normals that a thread takes at a time, and the initial capacity of its arrays of
# keys.
RANGE, ROOM = 1 << 13, 1 << 15
PATCHES_AT_A_TIME = 1 << 14


def find(
    spline: AnySpline,
    normals: Array,
    threads: int | None = None,
    progress: bool = False,
    components: bool = False,
) -> Hits:
    """Return all hits: pairs of one of the unit normals (S, 3) and a patch that has this normal.

    Where the normal is constant along a line, the hits are those of a slightly displaced normal:
    some points of the line, or none. With `components`, each connected set of points with the same
    normal has one hit.
    """
    check_memory("search", len(normals))
    return Hits.joined(list(find_in_turn(spline, normals, threads, progress, components)))


def find_in_turn(
    spline: AnySpline,
    normals: Array,
    threads: int | None = None,
    progress: bool = False,
    components: bool = False,
) -> Iterator[Hits]:
    """Yield hits, one `Hits` for each range of consecutive normals, so that memory is bounded.

    There is at least one range, also if there are no normals.
    """
    decided = _with_components if components else _with_points
    yield from _in_turn(spline, normals, decided, threads, progress)


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
    nothing = developable == spline.patches and decided is not _with_components
    if nothing or len(normals) == 0 or (tips is not None and tips.collapsed.all()):
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
    normals have more than MOST_HITS keys together.
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
    exact, local = np.empty(0, np.int64), np.empty((0, 6))
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


def _with_points(
    spline: AnySpline, normals: Array, certain: list[Indices], undecided: Indices,
    bounds: Array, developable: int, threads: int | None,
) -> Hits:  # fmt: skip
    """Return the hits as `_decided` does, but displace normals that lines in nets have."""
    hits = _decided(spline, normals, certain, undecided, bounds, developable, threads)
    if len(undecided) == 0 or not isinstance(spline, NetSpline):
        return hits
    numbers = np.unique(lines_of(spline, undecided, normals).keys >> 32)
    if len(numbers) == 0:
        return hits
    others = hits.rows(np.flatnonzero(~np.isin(hits.normal_index, numbers)))
    return others.merged(_displaced(spline, normals, numbers, threads))


def _with_components(
    spline: AnySpline, normals: Array, certain: list[Indices], undecided: Indices,
    bounds: Array, developable: int, threads: int | None,
) -> Hits:  # fmt: skip
    """Return the hits as `_decided` does, but one for each component; see `with_components`."""
    hits = _decided(spline, normals, certain, undecided, bounds, developable, threads)
    if len(undecided) == 0:
        return hits
    lines = lines_of(spline, undecided, normals)
    numbers = np.unique(np.concatenate([lines.keys >> 32, meeting(spline, hits)]))
    if len(numbers) == 0:
        return hits
    counted = hits
    if isinstance(spline, NetSpline):
        counted = _displaced(spline, normals, numbers, threads)
    return with_components(spline, hits, lines, numbers, counted)


def _displaced(spline: NetSpline, normals: Array, numbers: Indices, threads: int | None) -> Hits:
    """Return the hits of slightly displaced normals in place of those with the given indices."""
    beside = beside_lines(spline, normals[numbers])
    found = Hits.joined(list(_in_turn(spline, beside, _decided, threads)))
    return replace(found, keys=numbers[found.normal_index] << 32 | found.patch_index)


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
