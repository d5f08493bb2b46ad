"""Parts that need no CAD file, for examples and tests."""

import itertools
from dataclasses import replace

import numpy as np

from .faces import face_surface
from .part import Part, part_of
from .records import EdgeRecord, FaceRecord, Geometry, Net, PartRecord


def box(width: float = 1.0, depth: float = 2.0, height: float = 3.0) -> Part:
    """Return a box in mm with a corner at the origin, and normals that point outward.

    Examples
    --------
    >>> from gaussmap.tools.cad.examples import box
    >>> box(), box().area
    (Part(box: 6 faces, 1 solid, mm), 22.0)

    """
    faces, edges = box_faces(width, depth, height), box_edges(width, depth, height)
    corners = np.array([[k >> axis & 1 for axis in range(3)] for k in range(8)])
    vertices = corners * [width, depth, height]
    known = {x.vertices: k for k, x in enumerate(edges)}
    for k, face in enumerate(faces):
        across, along, far = (k // 2 + 1) % 3, (k // 2 + 2) % 3, (k % 2) << k // 2
        around = [far, far | 1 << across, far | 1 << across | 1 << along, far | 1 << along]
        wire = []
        for first, last in zip(around, [*around[1:], far], strict=True):
            edge = known[min(first, last), max(first, last)]
            wire.append((edge, edges[edge].faces.index(k), first > last))
        faces[k] = replace(face, wires=[wire])
    return part_of(PartRecord("box", "mm", 1e-3, True, faces, ["box"], edges, vertices))


def box_faces(width: float = 1.0, depth: float = 2.0, height: float = 3.0) -> list[FaceRecord]:
    """Return the faces of a box."""
    size, axes, found = np.array([width, depth, height]), np.eye(3), []
    for k in range(3):
        across, along = (k + 1) % 3, (k + 2) % 3
        a, b = float(size[across]), float(size[along])
        loop = np.array([(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)])
        for far in (False, True):
            origin = size * axes[k] * far
            numbers = np.concatenate([origin, axes[across], axes[along], axes[k]])
            face = FaceRecord(
                Geometry("plane", numbers),
                ((0.0, a), (0.0, b)),
                loops=[loop],
                reversed=not far,
                area=a * b,
                name="side",
                solid_index=0,
            )
            found.append(face)
    return found


def box_edges(width: float = 1.0, depth: float = 2.0, height: float = 3.0) -> list[EdgeRecord]:
    """Return the twelve sharp edges between the faces of `box_faces`.

    The vertices have the indices 0 to 7. Bit k of an index is 1 at the upper end of axis k.
    """
    size, found = np.array([width, depth, height]), []
    for first, second in itertools.combinations(range(3), 2):
        for far in itertools.product((False, True), repeat=2):
            ends = np.zeros((2, 3))
            ends[1, 3 - first - second] = size[3 - first - second]
            ends[:, [first, second]] = size[[first, second]] * far
            columns = [(k + step) % 3 for k in (first, second) for step in (1, 2)]
            faces = 2 * first + far[0], 2 * second + far[1]
            low = (far[0] << first) + (far[1] << second)
            vertices = low, low + (1 << 3 - first - second)
            found.append(EdgeRecord(faces, ends[:, columns], vertices=vertices))
    return found


def all_kinds() -> Part:
    """Return a part with faces of all kinds, each trimmed by a circle in its parameters.

    Examples
    --------
    >>> from gaussmap.tools.cad.examples import all_kinds
    >>> [face.kind for face in all_kinds().faces][-3:]
    ['revolution', 'extrusion', 'offset']

    """
    place, z = np.concatenate([np.zeros(3), np.eye(3).ravel()]), np.array([0.0, 0.0, 1.0])
    knots, u = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), np.arange(3) / 2.0
    x, y = np.meshgrid(u, u, indexing="ij")
    points, weights = np.stack([x, y, x * x + x * y], axis=2), 1.0 + x * y
    curve = Net((2,), (knots,), points[1] + [1.0, 0.0, 0.0], weights[1])
    nets = [Net((2, 2), (knots, knots), points, w) for w in (None, weights)]
    geometries = [
        Geometry("plane", place),
        *(Geometry(kind, np.append(place, 1.0)) for kind in ("cylinder", "sphere")),
        *(Geometry(kind, np.append(place, [2.0, 0.5])) for kind in ("cone", "torus")),
        *(Geometry("nurbs", net=net) for net in nets),
        Geometry("revolution", np.concatenate([np.zeros(3), z]), curve),
        Geometry("extrusion", z, curve),
        Geometry("offset", np.array([0.1]), basis=Geometry("nurbs", net=nets[1])),
    ]
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    circle = 0.5 + 0.4 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    slopes = 0.8 * np.pi * np.stack([-np.sin(angles), np.cos(angles)], axis=1)
    ends, faces, edges, vertices = (0.1, 0.9), [], [], []
    for k, geometry in enumerate(geometries):
        loops, wires = [circle[:-1]], [[(k, 0, False)]]
        faces.append(FaceRecord(geometry, (ends, ends), loops=loops, area=0.5, wires=wires))
        edges.append(EdgeRecord((k,), circle, slopes, vertices=(k, k)))
        vertices.append(face_surface(geometry, (ends, ends)).jets(*circle[:1].T)[0, 0])
    found = PartRecord("kinds", "mm", 1e-3, False, faces, (), edges, np.array(vertices))
    return part_of(found)
