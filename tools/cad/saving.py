"""Parts in files: NumPy archives of some 30 arrays, readable without a CAD library.

Nothing is pickled. For F faces, and S ≥ F surfaces of which the first F are those of the faces:

about (uint8)
    UTF-8 text, JSON: format, version, name, unit ("mm", "in", ...), metres (the length of the
    unit), oriented, solid_names (a list), face_names and reasons (by the index of the face, as
    text; a face with a reason has failed), warnings (a list of sentences), source_indices (the
    indices of selected faces in the part that was read or made, or an empty list).
reversed (F,) bool, area (F,), solid_index (F,) int64, color (F, 3)
    Whether normals point along −(x_u × x_v); the area inside the trim, in L²; the solid, −1 for
    none; red, green and blue from 0 to 1, NaN for none.
domain (F, 2, 2), periods (F, 2)
    ((u0, u1), (v0, v1)), the bounding box of the loops; the periods in u and v, or 0.
kind (S,) int8, basis (S,) int64, net (S,) int64
    The index in `records.KINDS`; the basis of an offset, else −1; the NURBS, or −1.
numbers (k,), number_starts (S + 1,) int64
    The numbers of surface i are numbers[number_starts[i]:number_starts[i + 1]], see below.
net_degrees (N, 2) int64, net_shapes (N, 2) int64
    The degrees p, q and numbers m, n of control points; q = 0 and n = 1 for a curve.
knots (k,), knot_starts (N + 1,) int64
    m + p + 1 knots along u and, if it is not a curve, n + q + 1 along v.
net_points (k, 4), net_point_starts (N + 1,) int64
    m n control points, v runs faster; not multiplied by the weight, the fourth number.
loop_points (k, 2), loop_point_starts (L + 1,) int64, face_loops (F + 1,) int64
    The loops of face i are face_loops[i] to face_loops[i + 1] − 1, closed polygons in u and v; the
    first point is not repeated. A point is inside if it, or a copy of it shifted by whole periods,
    is inside by the even-odd rule over all loops of a face. Loops run along seams; their u and v
    are not taken modulo the periods.
vertices (V, 3), edge_vertices (E, 2) int64, edge_degenerate (E,) bool
    The points at the ends of edges; for each edge, the indices of its first and last vertex, −1 if
    unknown; whether the edge is collapsed to a point, as at a pole.
edge_side_starts (E + 1,) int64, side_faces (U,) int64, side_points (k, 4), side_point_starts
    (U + 1,) int64. The sides of edge i are edge_side_starts[i] to edge_side_starts[i + 1] − 1: one
    on a boundary, two between faces and at seams, which are twice on the same face. For each side,
    the face, and u, v and their derivatives at equal steps of a parameter of the edge that goes
    from 0 to 1; NaN where unknown. All sides of an edge have equally many points.
wire_sides (k,) int64, wire_reversed (k,) bool, wire_side_starts (W + 1,) int64, face_wires (F + 1,)
    The wires of face i are face_wires[i] to face_wires[i + 1] − 1 (int64): the sides of edges along
    each of its loops, in order, and whether they are traversed from the end of the edge to its
    beginning. The face lies to the left of its wires, seen from where x_u × x_v points.

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

Faces of the kind "surface" are functions in memory, and in no file.
"""

import json
import math
from collections.abc import Mapping
from io import BufferedReader
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.archives import archive_of
from ..files.paths import PathLike, atomic_path, checked_path, known_suffix
from ..files.reading import UnusableError, opened
from .part_arrays import FORMAT, VERSION
from .records import KINDS

SUFFIXES = (".npz",)
# The largest size of the unpacked arrays of a file. A part of 100,000 faces takes about 1 GB.
MOST_BYTES = 4 << 30
Arrays = dict[str, NDArray[Any]]

# For each array, the letter of its type and its shape. Equal letters are equal lengths. "S:K" is
# the length S + 1 of the indices at which S runs start; the last index is K, the number of rows.
SHAPES: dict[str, tuple[str, tuple[str | int, ...]]] = {
    "about": ("B", ("A",)),
    "reversed": ("?", ("F",)),
    "area": ("d", ("F",)),
    "solid_index": ("q", ("F",)),
    "color": ("d", ("F", 3)),
    "domain": ("d", ("F", 2, 2)),
    "periods": ("d", ("F", 2)),
    "kind": ("b", ("S",)),
    "basis": ("q", ("S",)),
    "net": ("q", ("S",)),
    "numbers": ("d", ("K",)),
    "number_starts": ("q", ("S:K",)),
    "net_degrees": ("q", ("N", 2)),
    "net_shapes": ("q", ("N", 2)),
    "knots": ("d", ("T",)),
    "knot_starts": ("q", ("N:T",)),
    "net_points": ("d", ("C", 4)),
    "net_point_starts": ("q", ("N:C",)),
    "loop_points": ("d", ("P", 2)),
    "loop_point_starts": ("q", ("L:P",)),
    "face_loops": ("q", ("F:L",)),
    "vertices": ("d", ("V", 3)),
    "edge_vertices": ("q", ("E", 2)),
    "edge_degenerate": ("?", ("E",)),
    "edge_side_starts": ("q", ("E:U",)),
    "side_faces": ("q", ("U",)),
    "side_points": ("d", ("Q", 4)),
    "side_point_starts": ("q", ("U:Q",)),
    "wire_sides": ("q", ("R",)),
    "wire_reversed": ("?", ("R",)),
    "wire_side_starts": ("q", ("W:R",)),
    "face_wires": ("q", ("F:W",)),
}
MOST_DEGREE = 25
# The types of the entries of `about`: one value, a list, or a dictionary by the index of the face.
ABOUT: dict[str, tuple[type, type | tuple[type, ...]]] = {
    "name": (object, str),
    "unit": (object, str),
    "metres": (object, (int, float)),
    "oriented": (object, bool),
    "solid_names": (list, str),
    "face_names": (dict, str),
    "reasons": (dict, str),
    "warnings": (list, str),
    "source_indices": (list, int),
}
# The reasons why single faces are unusable, while the other faces of the part are used.
NOT_FINITE = "its numbers are not finite"
WRONG_AREA, FAR_AWAY = "its area is out of range", "its boundary is outside of its domain"
# The bounds of areas: squares of areas must neither overflow nor underflow.
LEAST_AREA, MOST_AREA = 1e-150, 1e150
# Loops may exceed the domain by this fraction of its size.
SLACK = 1e-6


def write_arrays(arrays: Mapping[str, NDArray[Any]], path: PathLike) -> None:
    """Write the arrays of a part to a file.

    Raises UnknownNameError unless the suffix is .npz, and FileError if it cannot be written.
    """
    known_suffix(path, SUFFIXES)
    with atomic_path(path) as temporary, open(temporary, "wb") as file:
        held: dict[str, Any] = {name: arrays[name] for name in SHAPES}
        np.savez(file, **held)


def read_arrays(path: PathLike) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Return the checked arrays of a part, and the entries of `about`.

    Raises FileError, in one sentence, for any other file.
    """
    path = checked_path(path)
    known_suffix(path, SUFFIXES)
    with opened(path, ".npz file of a part", "numbers") as file:
        return _read(file)


def _read(file: BufferedReader) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    with archive_of(file) as archive:
        if archive.unpacked > MOST_BYTES:
            raise UnusableError("claims to hold more than 4 GB, and is not read.")
        missing = [name for name in SHAPES if name not in archive.names]
        if missing:
            raise UnusableError(f"is no part that gaussmap saved: it lacks {missing[0]!r}.")
        return checked_arrays({name: archive.read(name) for name in SHAPES})


def about_of(arrays: Arrays) -> dict[str, Any]:
    """Return the contents of the array `about`."""
    return json.loads(arrays["about"].tobytes().decode())


def checked_arrays(arrays: Arrays) -> tuple[Arrays, dict[str, Any]]:
    """Return the arrays of a part, checked, and the contents of `about`; UnusableError if invalid.

    A face with numbers that are not finite or out of range has failed, and gets a reason; the other
    faces are kept.
    """
    about = about_of(arrays)
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise UnusableError("is no part that gaussmap saved.")
    if about.get("version") != VERSION:
        raise UnusableError("comes from another version of gaussmap; read the CAD file again.")
    found = {name: _typed(name, arrays[name]) for name in SHAPES}
    _check_lengths(found)
    _check_surfaces(found)
    _check_nets(found)
    faces = len(found["area"])
    _check_about(about, faces)
    solids = max(len(about.get("solid_names", ())), 1) if faces else 0
    _require(_within(found["solid_index"], -1, max(faces, solids)), "solid_index")
    _check_edges(found)
    reasons = _out_of_range(found) | _not_finite(found) | about.get("reasons", {})
    wrong = [int(k) for k, why in reasons.items() if why == WRONG_AREA]
    found["area"][wrong] = 0.0
    return found, {**about, "reasons": reasons}


def _check_about(about: dict[str, Any], faces: int) -> None:
    """Check the entries that `about` has; none of them is required."""
    for name in ABOUT.keys() & about.keys():
        (whole, kind), value = ABOUT[name], about[name]
        _require(isinstance(value, whole), "about")
        values = value.values() if whole is dict else value if whole is list else [value]
        same = (isinstance(x, kind) and (kind is bool or not isinstance(x, bool)) for x in values)
        _require(all(same), "about")
    _require(0.0 < about.get("metres", 1.0) < math.inf, "about")
    indices = {str(k) for k in range(faces)}
    _require(indices.issuperset(about.get("face_names", ())), "about")
    _require(indices.issuperset(about.get("reasons", ())), "about")
    _require(len(about.get("source_indices", ())) in (0, faces), "about")


def _typed(name: str, array: NDArray[Any]) -> NDArray[Any]:
    letter, shape = SHAPES[name]
    wanted = np.dtype(letter)
    same = array.dtype.kind == wanted.kind and array.dtype.itemsize == wanted.itemsize
    _require(same and array.ndim == len(shape), name)
    return np.ascontiguousarray(array, dtype=wanted)


def _check_lengths(arrays: Arrays) -> None:
    """Check the shapes of all arrays, and that the indices of runs increase up to their end."""
    lengths: dict[str, int] = {}
    for name, (_, shape) in SHAPES.items():
        for length, wanted in zip(arrays[name].shape, shape, strict=True):
            if isinstance(wanted, int):
                _require(length == wanted, name)
            else:
                count = length - (":" in wanted)
                _require(lengths.setdefault(wanted[0], count) == count >= 0, name)
    _require(lengths["F"] <= lengths["S"], "kind")
    for name, (_, (first, *_)) in SHAPES.items():
        if ":" in str(first):
            starts, rows = arrays[name], lengths[str(first)[2]]
            _require(starts[0] == 0 and starts[-1] == rows and (np.diff(starts) >= 0).all(), name)


def _check_surfaces(arrays: Arrays) -> None:
    """Check that each surface has the numbers, the net and the basis that its kind needs."""
    kind, net, basis = arrays["kind"], arrays["net"], arrays["basis"]
    names, sizes = list(KINDS), np.array([x.numbers for x in KINDS.values()])
    _require(_within(kind, 0, len(names)), "kind")
    _require((kind != names.index("surface")).all(), "kind")
    failed = kind == names.index("unknown")
    _require((failed | (np.diff(arrays["number_starts"]) == sizes[kind])).all(), "numbers")
    with_net = np.isin(kind, [names.index(x) for x in ("nurbs", "revolution", "extrusion")])
    _require(_within(net, -1, len(arrays["net_shapes"])), "net")
    _require((~with_net | (net >= 0)).all(), "net")
    places = np.arange(len(kind))
    # A basis comes after the surfaces that use it, so that there are no cycles.
    _require(((basis == -1) | ((basis > places) & (basis < len(kind)))).all(), "basis")
    _require(((kind != names.index("offset")) | (basis >= 0)).all(), "basis")
    curves = arrays["net_degrees"][:, 1] == 0
    is_curve = np.where(net >= 0, np.append(curves, False)[net], False)
    _require((~with_net | (is_curve == (kind != names.index("nurbs")))).all(), "net")


def _check_nets(arrays: Arrays) -> None:
    """Check that the numbers of knots and control points of each NURBS match its degrees and shape.

    Also check the range of the degrees and numbers.
    """
    degrees, shapes = arrays["net_degrees"], arrays["net_shapes"]
    curves = degrees[:, 1] == 0
    _require(_within(degrees[:, 0], 1, MOST_DEGREE + 1), "net_degrees")
    _require(_within(degrees[:, 1], 0, MOST_DEGREE + 1), "net_degrees")
    _require(_within(shapes, 1, 1 << 30) and (shapes[curves, 1] == 1).all(), "net_shapes")
    along_u, along_v = (shapes + degrees + 1).T
    _require((np.diff(arrays["net_point_starts"]) == shapes.prod(axis=1)).all(), "net_points")
    wanted = along_u + np.where(curves, 0, along_v)
    _require((np.diff(arrays["knot_starts"]) == wanted).all(), "knots")


def _check_edges(arrays: Arrays) -> None:
    """Check that each side of an edge is on a face, and the sides of a wire on the wire's face."""
    faces, sides = len(arrays["area"]), arrays["side_faces"]
    _require(_within(sides, 0, faces), "side_faces")
    _require(_within(arrays["edge_vertices"], -1, len(arrays["vertices"])), "edge_vertices")
    counts, starts = np.diff(arrays["side_point_starts"]), arrays["edge_side_starts"]
    first = np.repeat(starts[:-1], np.diff(starts))
    _require((counts == counts[first]).all(), "side_point_starts")
    _require(_within(arrays["wire_sides"], 0, len(sides)), "wire_sides")
    owner = np.repeat(np.arange(faces), np.diff(arrays["face_wires"]))
    on_face = np.repeat(owner, np.diff(arrays["wire_side_starts"]))
    _require((sides[arrays["wire_sides"]] == on_face).all(), "wire_sides")


def _not_finite(arrays: Arrays) -> dict[str, str]:
    """Return a reason for each face with numbers that are not finite, by its index."""
    faces, surfaces = len(arrays["area"]), len(arrays["kind"])
    bad = np.zeros(surfaces, dtype=np.bool_)
    bad |= _holds_bad(arrays["numbers"], arrays["number_starts"])
    nets = _holds_bad(arrays["knots"], arrays["knot_starts"])
    nets |= _holds_bad(arrays["net_points"], arrays["net_point_starts"])
    bad |= np.append(nets, False)[arrays["net"]]
    for k in np.flatnonzero(arrays["basis"] >= 0)[::-1].tolist():
        bad[k] |= bad[arrays["basis"][k]]
    loops = _holds_bad(arrays["loop_points"], arrays["loop_point_starts"])
    of_face = bad[:faces] | _any_between(loops, arrays["face_loops"])
    for name in ("area", "domain", "periods"):
        of_face |= _bad_rows(arrays[name])
    return dict.fromkeys(map(str, np.flatnonzero(of_face).tolist()), NOT_FINITE)


def _out_of_range(arrays: Arrays) -> dict[str, str]:
    """Return a reason for each face with an impossible area or loop, by its index."""
    area, domain = arrays["area"], arrays["domain"]
    wrong = ~((area >= LEAST_AREA) & (area <= MOST_AREA))
    counts = np.diff(arrays["loop_point_starts"])
    of_loop = np.repeat(np.arange(len(area)), np.diff(arrays["face_loops"]))
    owner = np.repeat(of_loop, counts)
    low, high = domain[owner, :, 0], domain[owner, :, 1]
    slack, points = SLACK * (high - low), arrays["loop_points"]
    far = ~((points >= low - slack) & (points <= high + slack)).all(axis=1)
    outside = np.zeros(len(area), dtype=np.bool_)
    outside[owner[far]] = True
    return dict.fromkeys(map(str, np.flatnonzero(outside).tolist()), FAR_AWAY) | dict.fromkeys(
        map(str, np.flatnonzero(wrong).tolist()), WRONG_AREA
    )


def _holds_bad(rows: NDArray[Any], starts: NDArray[np.int64]) -> NDArray[np.bool_]:
    return _any_between(_bad_rows(rows), starts)


def _bad_rows(rows: NDArray[Any]) -> NDArray[np.bool_]:
    return np.asarray(~np.isfinite(rows).all(axis=tuple(range(1, rows.ndim))))


def _any_between(flags: NDArray[np.bool_], starts: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return a mask of the runs starts[i]:starts[i + 1] in which any flag is set."""
    counts = np.concatenate([[0], np.cumsum(flags)])
    return counts[starts[1:]] > counts[starts[:-1]]


def _within(array: NDArray[Any], low: int, high: int) -> bool:
    return bool(((array >= low) & (array < high)).all())


def _require(holds: object, name: str) -> None:
    if not holds:
        raise UnusableError(f"is damaged: its array {name!r} is not what it should be; save again.")
