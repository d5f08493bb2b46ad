"""The parabolic curves of a spline: lines inside patches, and edges where K changes sign."""

from collections import defaultdict
from collections.abc import Hashable
from itertools import pairwise, product

import numpy as np

from ...generated import spline as grid
from ...runtime.base.aliases import Array, Indices
from ...runtime.spline.kernels.spline import patches_at
from ...runtime.spline.spline import Spline
from .chains import joined
from .classes import PatchClass, classes_of
from .image_curve import Zeros, jets_of_spline
from .parabolic_lines import cubic_bernstein, lines_of
from .patches import Patches

# The parameters u, v of the corners of a patch.
CORNERS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
# A point of an edge within this distance of a corner, in cells of the spline, counts as the corner.
AT_CORNER = 1e-9
# The distance from a segment, in cells of the spline, at which the sign of K is taken on both
# sides.
ASIDE = 1e-7
CURVED = PatchClass.MIXED, PatchClass.ELLIPTIC, PatchClass.HYPERBOLIC


class ZerosOfSpline(Zeros):
    """The curves across which K of a spline changes its sign.

    They are exact: inside each patch and along its edges they are straight in the parameters.
    """

    def __init__(self, spline: Spline) -> None:
        self.spline, self.patches = spline, Patches.of_spline(spline)
        self.classes = classes_of(self.patches)
        self.jets, self.size = jets_of_spline(spline), spline.extent[0]
        curved = np.isin(self.classes, CURVED).reshape(*spline.cells, 4)
        self.flat = np.logical_not(np.any(curved, axis=2))
        start, step = spline.frame[:2], spline.frame[2:]
        self.lines = [
            low + np.arange(count + 1) * size
            for low, count, size in zip(start, spline.cells, step, strict=True)
        ]
        self.periodic = np.array([ends[0] == "periodic" for ends in spline.boundary])

    def polylines(self) -> list[Array]:
        """Return the curves as polylines (k, 2) of the parameters."""
        lines = [
            (int(k), self._places(np.array([k]), line.segment)[0])
            for k in np.flatnonzero(self.classes == PatchClass.MIXED)
            for line in lines_of(self.patches[k : k + 1])
            if line.segment is not None
        ]
        inner = np.reshape([ends for _, ends in lines], (-1, 2, 2))
        segments = np.concatenate([inner, self._edges(lines)])
        across = np.diff(segments, axis=1)[:, 0, ::-1] * [1.0, -1.0]
        across *= ASIDE / np.linalg.norm(across, axis=1, keepdims=True)
        left, right = (self._signs(segments.mean(axis=1) + x) for x in (across, -across))
        period = np.where(self.periodic, self.spline.cells, np.inf)

        def node(place: Array) -> Hashable:
            return tuple(np.round(np.mod(place + 0.1 * AT_CORNER, period) / AT_CORNER).tolist())

        pieces = [(node(x[0]), node(x[1]), x) for x in segments[left * right < 0.0]]
        frame = self.spline.frame
        return [frame[:2] + x * frame[2:] for x, _ in joined(pieces)]

    def _places(self, patches: Indices, local: Array) -> Array:
        """Return points (k, n, 2), in cells, from parameters (n, 2) relative to each patch (k,)."""
        cell = np.stack(np.divmod(patches // 4, self.spline.cells[1]), axis=-1)
        return cell[:, None] + 0.5 + local @ grid.CORNERS[patches % 4]

    def _edges(self, lines: list[tuple[int, Array]]) -> Array:
        """Return the edges of patches (k, 2, 2), each once, cut where parabolic lines end on them.

        `lines` are the parabolic lines of patches: the index of a patch, and two ends, in cells.
        """
        corners = self._places(np.arange(self.spline.patches), CORNERS)
        ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 2)
        # Each inner edge occurs in both of its patches: both give it the same direction.
        turned = np.diff(ends, axis=1)[:, 0] @ [2.0, 1.0] < 0.0
        ends[turned] = ends[turned, ::-1]
        period = np.where(self.periodic, 4 * np.array(self.spline.cells), np.iinfo(np.int64).max)
        names = np.round(4.0 * ends.mean(axis=1)).astype(np.int64) % period
        _, first, number = np.unique(names, axis=0, return_index=True, return_inverse=True)
        cuts: dict[int, set[float]] = defaultdict(lambda: {0.0, 1.0})
        for (patch, places), edge in product(lines, range(3)):
            start, end = ends[3 * patch + edge]
            for place in places:
                share = float((place - start) @ (end - start) / ((end - start) @ (end - start)))
                off = np.abs(place - start - share * (end - start)).max()
                if off <= AT_CORNER and AT_CORNER < share < 1.0 - AT_CORNER:
                    cuts[int(number[3 * patch + edge])].add(share)
        whole = np.ones(len(first), dtype=bool)
        whole[list(cuts)] = False
        parts = [
            ends[first[k], 0] + np.multiply.outer(pair, ends[first[k], 1] - ends[first[k], 0])
            for k, shares in cuts.items()
            for pair in pairwise(sorted(shares))
            if pair[1] - pair[0] > AT_CORNER
        ]
        return np.concatenate([ends[first[whole]], np.reshape(parts, (-1, 2, 2))])

    def _signs(self, places: Array) -> Array:
        """Return the signs of K (k,) at points (k, 2), in cells; 0 outside, and where K is zero."""
        size = np.array(self.spline.cells)
        places = np.where(self.periodic, np.mod(places, size), places)
        inside = ((places >= 0.0) & (places < size)).all(axis=1)
        patch, uv = np.empty(len(places), dtype=np.int64), np.empty((len(places), 2))
        patches_at(*self.spline.cells, places, patch, uv)
        D = np.einsum("kd,kd->k", cubic_bernstein(uv), self.patches.cubic[patch])
        known = [inside & (self.classes[patch] == x) for x in CURVED]
        return np.select(known, [np.sign(D), np.ones(len(D)), -np.ones(len(D))])
