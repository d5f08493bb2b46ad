"""Selecting faces of a part as a new part."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.checks import (
    finite_array,
    known_name,
    listed,
    positive_number,
    real_values,
    text,
)
from ...runtime.base.errors import InputError, shown
from ...runtime.base.kept import kept
from ...runtime.directions.unit import normalized, unit_vector
from .face_pieces import FacePiece, pieces_of
from .part import Face, Part, part_of
from .records import KINDS, EdgeRecord, FaceRecord, PartRecord

Axis = tuple[ArrayLike, SupportsFloat]

# Colours may be rounded to 8 bits.
SAME_COLOUR = 0.75 / 255.0


def select(
    self: Part,
    *,
    kind: str | Sequence[str] | None = None,
    name: str | None = None,
    color: str | ArrayLike | None = None,
    index: ArrayLike | None = None,
    normal: Axis | None = None,
) -> Part:
    """Return the faces that satisfy all conditions, as a part.

    Parameters
    ----------
    kind : str or sequence of str, optional
        One of the kinds of `Face.kind`, or several.
    name : str, optional
        The name of the face, or a pattern such as "slot*", in which upper and lower case differ.
    color : str or (3,) array_like, optional
        The colour: "#ff8000", or red, green and blue from 0 to 1.
    index : array_like of int, optional
        Indices in `faces`, in any order; repeated indices count once.
    normal : ((3,) array_like, float), optional
        A direction (not 0), and an angle in degrees: all normals of the face, checked on a grid
        inside and along its boundary, are within this angle of the direction.

    Returns
    -------
    Part
        The faces, in their order, with their solids and the edges between them. `Face.source_index`
        is the index of each face in the part that was read or made.

    Raises
    ------
    InputError, UnknownNameError
        If no face satisfies all conditions, or a condition is invalid.

    Examples
    --------
    >>> from gaussmap.tools.cad.examples import box
    >>> part = box(1.0, 2.0, 3.0)
    >>> top = part.select(kind="plane", normal=([0, 0, 1], 5.0))
    >>> top, top.faces[0].source_index, top.area
    (Part(box: 1 face, 1 solid, mm), 5, 2.0)

    """
    chosen = np.ones(len(self), dtype=np.bool_)
    for condition in _conditions(self, kind, name, color, index):
        chosen &= condition
    if normal is not None:
        chosen &= _facing(self, normal, chosen)
    if not chosen.any():
        counts = Counter(x.kind for x in self.faces)
        held = ", ".join(f"{number:,} {kind}" for kind, number in counts.most_common())
        raise InputError(
            f"part {self.name!r} has no face that fulfils all conditions; the kinds of its faces "
            f"are: {held}."
        )
    return _part(self, np.flatnonzero(chosen).tolist())


def _conditions(
    part: Part,
    kind: str | Sequence[str] | None,
    name: str | None,
    color: str | ArrayLike | None,
    index: ArrayLike | None,
) -> list[Flags]:
    """Return masks of the faces (F,) for all given conditions except `normal`."""
    found = []
    if kind is not None:
        kinds = [kind] if isinstance(kind, str) else listed(kind)
        if kinds is None:
            raise InputError(f"kind must be a name or a list of names, not {shown(kind)}.")
        known = {known_name(x, tuple(KINDS), "kind of face") for x in kinds}
        found.append([x.kind in known for x in part.faces])
    if name is not None:
        pattern = text(name, "name")
        found.append([fnmatchcase(x.name, pattern) for x in part.faces])
    if color is not None:
        away = np.abs(part.arrays["color"] - _colour(color)).max(axis=1)
        found.append(away <= SAME_COLOUR)  # false for NaN
    if index is not None:
        found.append(_at(index, len(part)))
    return [np.asarray(x, dtype=np.bool_) for x in found]


def _colour(color: str | ArrayLike) -> Array:
    """Return red, green and blue (3,) from 0 to 1."""
    if not isinstance(color, str):
        return finite_array(color, (3,), "color")
    if not re.fullmatch("#[0-9a-fA-F]{6}", color):
        raise InputError(
            f'color must be a text such as "#ff8000", or three numbers, not {shown(color)}.'
        )
    return np.array(list(bytes.fromhex(color[1:]))) / 255.0


def _at(index: ArrayLike, count: int) -> Flags:
    """Return a mask (count,) of the faces with the given indices; InputError if one is invalid."""
    places = np.atleast_1d(real_values(index, "index"))
    chosen = np.zeros(count, dtype=np.bool_)
    if places.dtype.kind not in "iu" or places.ndim != 1:
        raise InputError(f"index must be whole numbers, indices of faces, not {shown(index)}.")
    bad = places[(places < 0) | (places >= count)]
    if len(bad):
        raise InputError(f"index holds {bad[0]}, and the faces are 0 to {count - 1:,}.")
    chosen[places] = True
    return chosen


def _facing(part: Part, normal: Axis, asked: Flags) -> Flags:
    """Return a mask of the faces whose normals are all within an angle of an axis.

    Only the faces in the mask `asked` are tested.
    """
    pair = listed(normal)
    if pair is None or len(pair) != 2:
        raise InputError(f"normal must be (direction, angle in degrees), not {shown(normal)}.")
    axis = unit_vector(pair[0], "the direction of normal")
    angle = positive_number(pair[1], "the angle of normal", "degrees", 180.0)
    least, facing = np.cos(np.radians(angle)), np.zeros(len(part), dtype=np.bool_)
    for piece in pieces_of(tuple(part.faces[k] for k in np.flatnonzero(asked)))[0]:
        facing[piece.face.index] = (_normals(piece) @ axis >= least).all()
    return facing


def _normals(piece: FacePiece) -> Array:
    """Return unit normals (k, 3) of a face: at centres and corners of its boxes, on its loops."""
    u0, v0, u1, v1 = piece.boxes.T
    middle = np.stack([u0 + u1, v0 + v1], axis=1) / 2.0
    corners = [np.stack(x, axis=1) for x in ((u0, v0), (u1, v0), (u0, v1), (u1, v1))]
    places = np.concatenate([middle, *corners])
    if piece.surface.trim is not None:
        places = places[piece.surface.trim.contains(places)]
    places = np.concatenate([places, *piece.polygons])
    jets = piece.jets(*places.T.copy())
    along_u, along_v = (normalized(jets[:, k]) for k in (1, 2))
    normals = np.cross(along_u, along_v)
    return normalized(normals[np.abs(normals).max(axis=1) > np.finfo(np.float64).eps])


# --- the part -------------------------------------------------------------------------------------


def _part(part: Part, chosen: list[int]) -> Part:
    """Return a part that consists of the faces with the indices `chosen`, in this order."""
    faces = [part.faces[k] for k in chosen]
    solids = sorted({x.solid_index for x in faces} - {-1})
    new = {old: k for k, old in enumerate(solids)}
    edges, places = _edges(part, chosen)
    found = part_of(
        PartRecord(
            part.name,
            part.unit,
            part.metres,
            part.oriented,
            [_record(x, new.get(x.solid_index, -1), places) for x in faces],
            [part.solids[k].name for k in solids],
            edges,
            part.arrays["vertices"],
            part.warnings,
            [x.source_index for x in faces],
        )
    )
    kept(found, whole_part, lambda: whole_part(part))
    return found


def whole_part(part: Part) -> Part:
    """Return the part from which `part` was selected in this session, otherwise `part` itself."""
    return kept(part, whole_part, lambda: part)


def _record(face: Face, solid: int, places: dict[int, tuple[int, int]]) -> FaceRecord:
    """Return the record of a face, with its solid, and with new indices of sides of edges."""
    wires = [[(*places[x], backwards) for x, backwards in wire] for wire in face.wires]
    return FaceRecord(
        face.geometry, face.domain, face.periods, face.loops, face.reversed, face.area,
        face.name, face.color, solid, face.reason, wires,
    )  # fmt: skip


def _edges(part: Part, chosen: list[int]) -> tuple[list[EdgeRecord], dict[int, tuple[int, int]]]:
    """Return the edges of the chosen faces, with the new indices of faces.

    Also return, by old index of a side, its new edge and its index among the sides of that edge.
    """
    new = np.full(len(part), -1)
    new[chosen] = np.arange(len(chosen))
    arrays, found, places = part.arrays, list[EdgeRecord](), dict[int, tuple[int, int]]()
    faces, starts = new[arrays["side_faces"]].tolist(), arrays["side_point_starts"]
    for k, (first, last) in enumerate(itertools.pairwise(arrays["edge_side_starts"].tolist())):
        sides = [x for x in range(first, last) if faces[x] >= 0]
        if not sides:
            continue
        places |= {x: (len(found), place) for place, x in enumerate(sides)}
        points = [arrays["side_points"][starts[x] : starts[x + 1]] for x in sides]
        found.append(
            EdgeRecord(
                tuple(faces[x] for x in sides),
                np.concatenate([x[:, :2] for x in points], axis=1),
                np.concatenate([x[:, 2:] for x in points], axis=1),
                tuple(arrays["edge_vertices"][k].tolist()),
                bool(arrays["edge_degenerate"][k]),
            )
        )
    return found, places
