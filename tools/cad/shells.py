"""Shells: connected faces with consistent normals, which point out of solids and into cavities."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.errors import InputError
from ...runtime.base.trees import tree_of
from ...runtime.surface.derivatives import normals_of_jets
from .face_pieces import FacePiece
from .sewing import Border, Sewn

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# About PROBES points of a shell are tested; it counts as inside another shell if at least the
# fraction INSIDE of these points is.
PROBES, INSIDE = 100, 0.9


@dataclass(frozen=True)
class Shell:
    """Connected faces, and whether they are closed.

    `signs` are −1 for faces that are flipped, else 1, by face index. `solid` is the index of the
    solid that the shell encloses, or of which it bounds a cavity; −1 for none.
    """

    signs: dict[int, int]
    closed: bool
    solid: int = -1

    @property
    def flipped(self) -> Shell:
        """Return the shell with opposite normals."""
        return replace(self, signs={k: -sign for k, sign in self.signs.items()})


def shells_of(
    pieces: Sequence[FacePiece], found: Sewn, borders: Sequence[Border], heights: Sequence[float]
) -> list[Shell]:
    """Return the connected sets of faces, each with consistent normals.

    Normals of closed sets point out of solids, and so into cavities; open sets are oriented as
    their first face. `heights` are the integrals of (x − c)·n over the faces, with the same c.
    Raises InputError for a set that cannot be oriented.
    """
    shells = [_outward(x, heights) for x in _connected(pieces, found, borders)]
    closed = [k for k, x in enumerate(shells) if x.closed]
    # A shell can only be inside a larger one.
    closed.sort(key=lambda k: -sum(sign * heights[f] for f, sign in shells[k].signs.items()))
    points = {k: _Points.of(shells[k], pieces) for k in closed} if len(closed) > 1 else {}
    solid_of_hollow = dict[int, int]()
    for place, k in enumerate(closed):
        smallest = next((x for x in closed[:place][::-1] if points[x].hold(points[k])), None)
        if smallest is not None and smallest not in solid_of_hollow:
            solid_of_hollow[k] = smallest
    solids = [k for k in sorted(closed) if k not in solid_of_hollow]
    for k in closed:
        shells[k] = replace(
            shells[k].flipped if k in solid_of_hollow else shells[k],
            solid=solids.index(solid_of_hollow.get(k, k)),
        )
    return shells


def _outward(shell: Shell, heights: Sequence[float]) -> Shell:
    """Return a shell, flipped if it is closed and its normals point into it."""
    volume = sum(sign * heights[face] for face, sign in shell.signs.items())
    return shell.flipped if shell.closed and volume < 0.0 else shell


@dataclass(frozen=True, eq=False)
class _Points:
    """Points (k, 3) over a closed shell, a tree of them, and outward normals (k, 3) there."""

    points: Array
    normals: Array
    tree: KDTree

    @classmethod
    def of(cls, shell: Shell, pieces: Sequence[FacePiece]) -> _Points:
        jets = [pieces[face].on_raster() for face in shell.signs]
        signs = np.repeat(list(shell.signs.values()), [len(x) for x in jets])
        jets = np.concatenate(jets)
        return cls(jets[:, 0], signs[:, None] * normals_of_jets(jets), tree_of(jets[:, 0]))

    def hold(self, other: _Points) -> bool:
        """Return whether another shell is inside this one.

        A point of the other shell is inside if it is behind the nearest point of this shell. The
        other shell counts as inside if the fraction INSIDE of its tested points is.
        """
        probes = other.points[:: 1 + len(other.points) // PROBES]
        if not len(probes) or not len(self.points):
            return False
        nearest = self.tree.query(probes)[1]
        heights = np.einsum("kx,kx->k", probes - self.points[nearest], self.normals[nearest])
        return bool((heights < 0.0).mean() >= INSIDE)


def _connected(pieces: Sequence[FacePiece], found: Sewn, borders: Sequence[Border]) -> list[Shell]:
    """Return the connected sets of faces, each with consistent normals."""
    passed = defaultdict[int, list[tuple[int, bool]]](list)
    for border, wire in zip(borders, found.wires, strict=True):
        for edge, _, backwards in wire:
            passed[edge].append((border.face, backwards))
    links, is_open = defaultdict[int, list[tuple[int, int]]](list), set[int]()
    for edge, sides in passed.items():
        if found.edges[edge].degenerate:
            continue
        if len(sides) != 2:
            is_open |= {face for face, _ in sides}
            continue
        (one, first), (other, second) = sides
        sign = 1 if first != second else -1
        links[one].append((other, sign))
        links[other].append((one, sign))
    shells, known = [], dict[int, int]()
    for start in range(len(pieces)):
        if start not in known:
            signs = _signs(pieces, start, links)
            known |= signs
            shells.append(Shell(signs, not is_open & signs.keys()))
    return shells


def _signs(
    pieces: Sequence[FacePiece], start: int, links: dict[int, list[tuple[int, int]]]
) -> dict[int, int]:
    """Return the signs of the normals of all faces connected to the face `start`, by face index."""
    signs, waiting = {start: 1}, [start]
    for face in waiting:  # the list grows in the loop
        for other, sign in links.get(face, ()):
            if other not in signs:
                signs[other] = sign * signs[face]
                waiting.append(other)
            elif signs[other] != sign * signs[face]:
                name = pieces[other].face.name
                raise InputError(
                    f"surface {other} ({name!r}) closes a band that has one side only, as a Möbius "
                    "band has; the normals of a part have to be on one side."
                )
    return signs
