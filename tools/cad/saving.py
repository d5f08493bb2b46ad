"""Parts in files: NumPy archives of some 20 arrays, which need no CAD library to be read again.

Nothing is pickled. For F faces, and S ≥ F surfaces of which the first F are those of the faces:

about (uint8)
    UTF-8 text, JSON: format, version, name, unit ("mm", "in", ...), metres (the length of the
    unit), oriented, solid_names (a list), face_names and reasons (by the index of the face, as
    text; a face with a reason has failed), warnings (a list of sentences).
reversed (F,) bool, area (F,), solid_index (F,) int64, color (F, 3)
    Whether normals point along −(x_u × x_v); the area inside the trim, in L²; the solid, −1 for
    none; red, green and blue from 0 to 1, NaN for none.
domain (F, 2, 2), periods (F, 2)
    ((u0, u1), (v0, v1)), the bounds of the loops; the periods of the surface in u and v, or 0.
kind (S,) int8, basis (S,) int64, net (S,) int64
    The place in `records.KINDS`; of an offset the surface it has its distance from, else −1; the
    NURBS, or −1.
numbers (k,), number_starts (S + 1,) int64
    Those of surface i are numbers[number_starts[i]:number_starts[i + 1]], see below.
net_degrees (N, 2) int64, net_shapes (N, 2) int64
    The degrees p, q and numbers m, n of control points; q = 0 and n = 1 for a curve.
knots (k,), knot_starts (N + 1,) int64
    m + p + 1 knots along u and, if it is no curve, n + q + 1 along v.
net_points (k, 4), net_point_starts (N + 1,) int64
    m n control points, v runs faster; not multiplied by the weight, the fourth number.
loop_points (k, 2), loop_point_starts (L + 1,) int64, face_loops (F + 1,) int64
    The loops of face i are face_loops[i] to face_loops[i + 1] − 1, closed polygons in u and v; the
    first point is not repeated. A point is inside by the even-odd rule over all loops of a face, in
    any turn; loops run along seams, so that u and v are not taken modulo the periods.
edge_faces (E, 2) int64, edge_points (k, 4), edge_point_starts (E + 1,) int64
    The sharp edges: two faces, whose normals differ by more than `records.SHARP` degrees somewhere,
    and points along the edge, as u, v on the first and u, v on the second face.

A placement is the origin o and three orthonormal axes X, Y, Z, 12 numbers; Y may be −Z × X. With
c = cos u X + sin u Y the surfaces are, as in Open CASCADE and STEP,

    plane       placement               o + u X + v Y
    cylinder    placement, R            o + R c + v Z
    cone        placement, R, a         o + (R + v sin a) c + v cos a Z
    sphere      placement, R            o + R cos v c + R sin v Z
    torus       placement, R, r         o + (R + r cos v) c + r sin v Z
    nurbs       its net
    revolution  o, Z                    the curve of its net at v, turned about o, Z by u
    extrusion   Z                       the curve of its net at u, plus v Z
    offset      d                       its basis at u, v, plus d (x_u × x_v) / |x_u × x_v|
    unknown     (of faces that failed)
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BufferedReader
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.archives import archive_of
from ..files.paths import PathLike, atomic_path, checked_path, known_suffix
from ..files.reading import UnusableError, opened
from .checked_arrays import checked_arrays, dtypes
from .part_arrays import packed
from .records import PartRecord

__all__ = ["read_arrays", "write_arrays", "write_record"]

SUFFIXES = (".npz",)
# A part of 100,000 faces takes about 1 GB.
MOST_BYTES = 4 << 30


def write_record(record: PartRecord, path: PathLike) -> None:
    """Write a part that was just read; FileError if the file cannot be written."""
    write_arrays(packed(record), path)


def write_arrays(arrays: Mapping[str, NDArray[Any]], path: PathLike) -> None:
    """Write the arrays of a part; UnknownNameError unless the suffix is .npz, FileError."""
    known_suffix(path, SUFFIXES)
    with atomic_path(path) as temporary, open(temporary, "wb") as file:
        held: dict[str, Any] = {name: arrays[name] for name in dtypes()}
        np.savez(file, **held)


def read_arrays(path: PathLike) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Return the arrays of a part, checked, and what is in `about`.

    Raises FileError, in one sentence, for what is no such file.
    """
    path = checked_path(path)
    known_suffix(path, SUFFIXES)
    with opened(path, ".npz file of a part", "numbers") as file:
        return _read(file)


def _read(file: BufferedReader) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    with archive_of(file) as archive:
        missing = [name for name in dtypes() if name not in archive.names]
        if missing:
            raise UnusableError(f"is no part that gaussmap saved: it lacks {missing[0]!r}.")
        if archive.unpacked > MOST_BYTES:
            raise UnusableError("says that it holds more than 4 GB, and is not read.")
        arrays = {name: archive.read(name) for name in dtypes()}
    return checked_arrays(arrays)
