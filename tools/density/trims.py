"""The trims of all pieces, evaluated at points of many pieces."""

from collections.abc import Sequence

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.domain.trim import polygons_of
from .cells import grouped
from .piece import Piece

# The distance from a boundary to the points beside it, relative to the domain.
BESIDE = 1e-6


class Trims:
    """The trims of all pieces."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.trimmed = np.array([x.trim is not None for x in pieces], dtype=np.bool_)
        self.domains = np.array([x.domain for x in pieces])

    def contains(self, pieces: Indices, places: Array) -> Flags:
        """Return whether parameters (k, 2) of pieces (k,) are inside the trims of these pieces."""
        inside = np.ones(len(pieces), np.bool_)
        asked = np.flatnonzero(self.trimmed[pieces])
        for k, rows in grouped(pieces[asked]):
            here = asked[rows]
            inside[here] = self.pieces[k].contains(places[here])
        return inside

    def wrapped(self, pieces: Indices, places: Array) -> Array:
        """Return parameters (k, 2) of pieces (k,), all with a trim, modulo periods."""
        found = np.empty_like(places)
        for k, rows in grouped(pieces):
            found[rows] = self.pieces[k].wrapped(places[rows])
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
        for k, rows in grouped(pieces):
            trim = self.pieces[k].trim
            assert trim is not None
            for part in trim.parts:
                if not polygons_of(part):
                    allowed[rows] &= part.contains(places[rows])
        return allowed
