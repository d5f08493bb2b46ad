"""The trims of all pieces, evaluated at points of many pieces in one call."""

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.domain.domain import closes, less_periods
from ...runtime.domain.kernels.trim import Joined, find_inside_each
from ...runtime.domain.loops import Loops
from ...runtime.domain.trim import Turned
from .cells import grouped
from .piece import Piece

# The distance from a boundary to the points beside it, relative to the domain.
BESIDE = 1e-6
PLACES_AT_A_TIME = 1 << 17


class Trims:
    """The trims of all pieces.

    Trims that are loops, perhaps with u reversed, are joined, so that one call of a kernel
    evaluates them; other conditions are evaluated piece by piece.
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.trimmed = np.array([x.trim is not None for x in pieces], dtype=np.bool_)
        self.domains = np.array([x.domain for x in pieces])
        # For each piece, `_place` is the index of its loops in `_loops`, −1 if its trim is
        # evaluated alone; `_totals` is the sum of the bounds of u if u is reversed, otherwise NaN.
        self._place, self._totals = np.full(len(pieces), -1), np.full(len(pieces), np.nan)
        self._loops = list[Loops]()
        for k in np.flatnonzero(self.trimmed).tolist():
            trim = pieces[k].trim
            assert trim is not None
            part = trim.parts[0]
            loops = part.part if isinstance(part, Turned) else part
            mirrored = any("mirrored" in ends for ends in trim.boundary)
            alone = len(trim.parts) == 1 and trim.domain == pieces[k].domain
            if isinstance(loops, Loops) and alone and not mirrored:
                self._place[k] = len(self._loops)
                self._totals[k] = part.total if isinstance(part, Turned) else np.nan
                self._loops.append(loops)

    def contains(self, pieces: Indices, places: Array) -> Flags:
        """Return whether parameters (k, 2) of pieces (k,) are inside the trims of these pieces."""
        inside = np.ones(len(pieces), np.bool_)
        asked = np.flatnonzero(self.trimmed[pieces])
        for first in range(0, len(asked), PLACES_AT_A_TIME):
            rows = asked[first : first + PLACES_AT_A_TIME]
            is_joined = self._place[pieces[rows]] >= 0
            joined = rows[is_joined]
            if len(joined):
                inside[joined] = self._inside_loops(pieces[joined], places[joined])
            others = rows[~is_joined]
            for k, found in grouped(pieces[others]):
                here = others[found]
                inside[here] = self.pieces[k].contains(places[here])
        return inside

    def wrapped(self, pieces: Indices, places: Array) -> Array:
        """Return parameters (k, 2) of pieces (k,), modulo periods if the piece has a trim."""
        found = places.copy()
        is_joined = self._place[pieces] >= 0
        low, high = self.domains[pieces, :, 0], self.domains[pieces, :, 1]
        out = self._closes[pieces] & ((places < low) | (places > high)) & is_joined[:, None]
        found[out] = less_periods(places[out], low[out], high[out])[0]
        others = np.flatnonzero(~is_joined)
        for k, rows in grouped(pieces[others]):
            here = others[rows]
            found[here] = self.pieces[k].wrapped(places[here])
        return found

    def beside_border(self, piece: int, step: float) -> Array:
        """Return parameters (k, 2) inside a piece, beside its boundary, about `step` apart.

        The step is relative to the domain.
        """
        lines = list(self.pieces[piece].border_lines(step))
        steps = np.concatenate([np.empty((0, 2)), *(np.diff(x, axis=0) for x in lines)])
        places = np.concatenate([np.empty((0, 2)), *(x[:-1] for x in lines)]) + steps / 2.0
        return self.beside(np.full(len(places), piece), places, steps)[0]

    def beside(
        self, pieces: Indices, places: Array, steps: Array
    ) -> tuple[Array, Indices, Indices]:
        """Return parameters beside points (k, 2) of boundaries, on each side that is inside.

        Also return the indices of these points, and their sides; 0, the left side, comes first,
        then 1, the right side. The boundary runs along steps (k, 2) at the points. If neither side
        is inside, as in narrow tips, return the point itself, with the side 2.
        """
        low, high = self.domains[pieces, :, 0], self.domains[pieces, :, 1]
        along = steps / (high - low)
        lengths = np.hypot(*along.T)
        unit = along / np.where(lengths > 0.0, lengths, 1.0)[:, None]
        across = BESIDE * (high - low) * np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        twice = np.concatenate([pieces, pieces])
        both = self.wrapped(twice, np.concatenate([places + across, places - across]))
        ends = self.domains[twice]
        inside = np.asarray(((both > ends[:, :, 0]) & (both < ends[:, :, 1])).all(axis=1))
        inside[inside] = self.contains(twice[inside], both[inside])
        narrow = np.flatnonzero(~inside.reshape(2, -1).any(axis=0))
        on = np.clip(self.wrapped(pieces[narrow], places[narrow]), low[narrow], high[narrow])
        allowed = self._allow(pieces[narrow], on)
        numbers = np.tile(np.arange(len(places)), 2)[inside]
        return (
            np.concatenate([both[inside], on[allowed]]),
            np.concatenate([numbers, narrow[allowed]]),
            np.concatenate([np.repeat([0, 1], len(places))[inside], np.full(allowed.sum(), 2)]),
        )

    def _allow(self, pieces: Indices, places: Array) -> Flags:
        """Return whether parameters (k, 2) fulfil all conditions of trims that are not loops."""
        allowed = np.ones(len(places), np.bool_)
        others = np.flatnonzero(self._place[pieces] < 0)
        for k, rows in grouped(pieces[others]):
            here = others[rows]
            trim = self.pieces[k].trim
            assert trim is not None
            for part in trim.parts:
                if not isinstance(part.part if isinstance(part, Turned) else part, Loops):
                    allowed[here] &= part.contains(places[here])
        return allowed

    def _inside_loops(self, pieces: Indices, places: Array) -> Flags:
        """Return whether parameters (k, 2) of pieces (k,) are inside the loops of these pieces."""
        uv, totals, owners = self.wrapped(pieces, places), self._totals[pieces], self._place[pieces]
        uv[:, 0] = np.where(np.isnan(totals), uv[:, 0], totals - uv[:, 0])
        low, high = self._limits[owners, 0], self._limits[owners, 1]
        inside = np.empty(len(uv), np.bool_)
        find_inside_each(self._joined, owners, np.clip(uv, low, high), inside)
        return inside

    @cached_property
    def _closes(self) -> Flags:
        """(P, 2): whether u and v of pieces are periodic."""
        ends = [((), ()) if x.trim is None else x.trim.boundary for x in self.pieces]
        return np.array([[len(x) > 0 and closes(x) for x in y] for y in ends], dtype=np.bool_)

    @cached_property
    def _limits(self) -> Array:
        """(L, 2, 2): the smallest and largest parameters inside of loops."""
        return np.array([x.limits for x in self._loops])

    @cached_property
    def _joined(self) -> Joined:
        """The cells of all loops, and their shifts, concatenated."""
        # The cells of single loops are not cached, since they would take as much memory again.
        cells, shifts = zip(*(x.in_cells() for x in self._loops), strict=True)
        segments = _starts(x.segments for x in cells)
        return Joined(
            np.concatenate([x.segments for x in cells]),
            np.array([x.frame for x in cells]),
            np.concatenate([x.starts for x in cells], dtype=np.int32, casting="same_kind"),
            np.concatenate([x.members for x in cells]),
            np.concatenate([x.parity.ravel() for x in cells]),
            np.concatenate(shifts),
            np.stack([
                segments,
                _starts(x.starts for x in cells),
                _starts(x.members for x in cells),
                _starts(x.parity.ravel() for x in cells),
                _starts(shifts),
                np.array([*(len(x.parity) for x in cells), 0]),
            ], axis=1),
        )  # fmt: skip


def _starts(parts: Iterator[Array] | Sequence[Array]) -> Indices:
    """Return the offsets of arrays in their concatenation, followed by its length."""
    return np.cumsum([0, *map(len, parts)], dtype=np.int64)
