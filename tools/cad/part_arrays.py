"""A part as few long arrays: packing records, and unpacking the surface of one face.

The numbers of all faces are concatenated in one array, with an array of start indices, so that a
part of 100,000 faces has some 20 arrays. `saving` describes them.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .records import KINDS, FaceRecord, Geometry, Net, PartRecord

FORMAT = "gaussmap part"
# The version of the format, to be increased when the arrays change such that older versions of
# gaussmap would misread them.
VERSION = 2

Arrays = dict[str, NDArray[Any]]
NAMES = tuple(KINDS)


def packed(part: PartRecord) -> Arrays:
    """Return the arrays of a part, by the names in `saving`."""
    faces = part.faces
    geometries = [x.geometry for x in faces]
    basis = _basis(geometries)
    nets = [x.net for x in geometries if x.net is not None]
    held = np.array([x.net is not None for x in geometries], dtype=np.bool_)
    return {
        "about": np.frombuffer(json.dumps(_about(part)).encode(), dtype=np.uint8),
        **_table(faces),
        "kind": np.array([NAMES.index(x.kind) for x in geometries], dtype=np.int8),
        "basis": np.array(basis, dtype=np.int64),
        "net": np.where(held, np.cumsum(held) - 1, -1),
        **_rows("number", [np.asarray(x.numbers) for x in geometries], ()),
        **_nets(nets),
        **_loops(faces),
        **_edges(part),
        **_wires(part),
    }


def geometry_of(arrays: Mapping[str, NDArray[Any]], k: int) -> Geometry:
    """Return surface k of packed arrays: that of face k, or the basis of an offset."""
    starts, basis, net = arrays["number_starts"], int(arrays["basis"][k]), int(arrays["net"][k])
    return Geometry(
        NAMES[arrays["kind"][k]],
        arrays["numbers"][starts[k] : starts[k + 1]],
        None if net < 0 else _net_of(arrays, net),
        None if basis < 0 else geometry_of(arrays, basis),
    )


def _net_of(arrays: Mapping[str, NDArray[Any]], k: int) -> Net:
    rows = slice(*arrays["net_point_starts"][k : k + 2].tolist())
    knots = arrays["knots"][slice(*arrays["knot_starts"][k : k + 2].tolist())]
    (p, q), (m, n) = arrays["net_degrees"][k].tolist(), arrays["net_shapes"][k].tolist()
    points, weights = arrays["net_points"][rows, :3], arrays["net_points"][rows, 3]
    rational = None if (weights == 1.0).all() else weights
    if q == 0:
        return Net((p,), (knots,), points, rational)
    along_u, along_v = np.split(knots, [m + p + 1])
    weights = None if rational is None else rational.reshape(m, n)
    return Net((p, q), (along_u, along_v), points.reshape(m, n, 3), weights)


def _about(part: PartRecord) -> dict[str, Any]:
    """Return the entries of a part that are not arrays."""
    names = {k: x.name for k, x in enumerate(part.faces) if x.name}
    reasons = {k: x.reason for k, x in enumerate(part.faces) if x.reason}
    return {
        "format": FORMAT,
        "version": VERSION,
        "name": part.name,
        "unit": part.unit,
        "metres": part.metres,
        "oriented": part.oriented,
        "solid_names": list(part.solid_names),
        "face_names": names,
        "reasons": reasons,
        "warnings": list(part.warnings),
        "source_indices": list(part.source_indices),
    }


def _table(faces: Sequence[FaceRecord]) -> Arrays:
    """Return the arrays with one row for each face."""
    unknown = (np.nan, np.nan, np.nan)
    colors = [unknown if x.color is None else tuple(x.color) for x in faces]
    return {
        "reversed": np.array([x.reversed for x in faces], dtype=np.bool_),
        "area": np.array([x.area for x in faces], dtype=np.float64),
        "solid_index": np.array([x.solid_index for x in faces], dtype=np.int64),
        "color": np.array(colors, dtype=np.float64).reshape(-1, 3),
        "domain": np.array([x.domain for x in faces], dtype=np.float64).reshape(-1, 2, 2),
        "periods": np.array([x.periods for x in faces], dtype=np.float64).reshape(-1, 2),
    }


def _basis(geometries: list[Geometry]) -> list[int]:
    """Append the bases of offsets to `geometries`; return the index of each basis, −1 for none."""
    places: list[int] = []
    for geometry in geometries:  # the list grows, and the loop also visits the appended bases
        if geometry.basis is None:
            places.append(-1)
        else:
            places.append(len(geometries))
            geometries.append(geometry.basis)
    return places


def _nets(nets: Sequence[Net]) -> Arrays:
    """Return the arrays of all NURBS; along v, a curve has degree 0 and one control point."""
    points = []
    for net in nets:
        weights = np.ones(net.points.shape[:-1]) if net.weights is None else net.weights
        points.append(np.concatenate([net.points, weights[..., None]], axis=-1).reshape(-1, 4))
    shapes = [(*x.points.shape[:-1], 1)[:2] for x in nets]
    return {
        "net_degrees": np.array([(*x.degrees, 0)[:2] for x in nets], np.int64).reshape(-1, 2),
        "net_shapes": np.array(shapes, dtype=np.int64).reshape(-1, 2),
        **_rows("net_point", points, (4,)),
        **_rows("knot", [np.concatenate(x.knots) for x in nets], ()),
    }


def _loops(faces: Sequence[FaceRecord]) -> Arrays:
    """Return the loops of all faces, and the index of the first loop of each face."""
    counts = np.cumsum([0, *(len(x.loops) for x in faces)])
    loops = [loop for x in faces for loop in x.loops]
    return {"face_loops": counts.astype(np.int64), **_rows("loop_point", loops, (2,))}


def _edges(part: PartRecord) -> Arrays:
    """Return all vertices and edges, and the parameters of edges on faces."""
    edges, sides = part.edges, []
    for edge in edges:
        places = np.asarray(edge.parameters, dtype=np.float64)
        slopes = _differences(places) if edge.slopes is None else edge.slopes
        sides += [
            np.concatenate([places[:, k : k + 2], slopes[:, k : k + 2]], axis=1)
            for k in range(0, 2 * len(edge.faces), 2)
        ]
    return {
        "vertices": np.array(part.vertices, dtype=np.float64).reshape(-1, 3),
        "edge_vertices": np.array([x.vertices for x in edges], dtype=np.int64).reshape(-1, 2),
        "edge_degenerate": np.array([x.degenerate for x in edges], dtype=np.bool_),
        "edge_side_starts": np.cumsum([0, *(len(x.faces) for x in edges)], dtype=np.int64),
        "side_faces": np.array([k for x in edges for k in x.faces], dtype=np.int64),
        **_rows("side_point", sides, (4,)),
    }


def _differences(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the derivatives (k, …) of points at equal steps from 0 to 1, by finite differences."""
    return np.gradient(points, axis=0) * (len(points) - 1) if len(points) > 1 else 0.0 * points


def _wires(part: PartRecord) -> Arrays:
    """Return the sides of edges along the loops of all faces, in order."""
    starts = np.cumsum([0, *(len(x.faces) for x in part.edges)]).tolist()
    wires = [wire for x in part.faces for wire in x.wires]
    steps = [step for wire in wires for step in wire]
    return {
        "wire_sides": np.array([starts[edge] + side for edge, side, _ in steps], dtype=np.int64),
        "wire_reversed": np.array([backwards for *_, backwards in steps], dtype=np.bool_),
        "wire_side_starts": np.cumsum([0, *map(len, wires)], dtype=np.int64),
        "face_wires": np.cumsum([0, *(len(x.wires) for x in part.faces)], dtype=np.int64),
    }


def _rows(name: str, parts: Iterable[NDArray[Any]], shape: tuple[int, ...]) -> Arrays:
    """Return concatenated arrays, and the index of the first row of each.

    The last entry of the indices is the total number of rows.
    """
    rows = [np.empty((0, *shape)), *(np.asarray(x, np.float64).reshape(-1, *shape) for x in parts)]
    starts = np.cumsum([len(x) for x in rows], dtype=np.int64)
    return {f"{name}s": np.concatenate(rows), f"{name}_starts": starts}
