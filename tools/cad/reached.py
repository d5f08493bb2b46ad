"""The space of the points of a part that a probe can reach, and the weights of samples."""

import itertools
import math
from collections.abc import Iterator

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.errors import InputError, MissingFieldError
from ...runtime.base.kept import kept
from ...runtime.base.trees import tree_of
from ...runtime.directions.regions import Condition, Reach
from ...runtime.map import GaussMap
from ...runtime.onto_surface.on_spline import on_grids
from ...runtime.samples.samples import Samples
from ...runtime.surface.surface import Surface
from ..density.cells import AREA, runs
from ..density.kernels.sizing import TargetDensity
from ..edge_distance import AwayFrom
from ..meshes.rays import Free
from ..support_points import ROUNDING, Segments, lines_of
from .edges import sides_at
from .face_pieces import FacePiece
from .faces import own_parameters
from .measures import boundaries_of
from .obstacle import obstacle_of
from .part import Part
from .results import PartSpace, space_of

# The number of cells per sample. Each cell gives its area to the nearest sample.
CELLS_A_SAMPLE = 16
# The error of cubic interpolation, relative to that with every second point. It is about 1/16; a
# factor 2 is for safety.
OF_COARSER = 1.0 / 8.0


def reached(
    part: Part, threads: int | None, target: TargetDensity | None = None, reach: Reach | None = None
) -> PartSpace:
    """Return the space of a part, or of its points in a `reach`; SurfaceError if it is empty."""
    if reach is not None:
        reach = reach._on(_conditions(part, reach))
    return space_of(part, threads, target, reach)


def _conditions(part: Part, reach: Reach) -> list[Condition]:
    """Return the conditions of a reach on the points of a part."""
    found, distance = list[Condition | None](), reach._from_edges
    if distance is not None:
        borders = kept(part, borders_of, lambda: borders_of(part))
        found.append(kept(part, (AwayFrom, distance), lambda: AwayFrom.of(borders, distance)))
    return [*(x for x in found if x is not None), *_free(part, reach)]


def conditions_of(self: GaussMap, reach: Reach) -> list[Condition]:
    """Return the conditions that a reach sets on points of a surface, not those on normals."""
    found, surface = list[Condition | None](), self.surface
    if reach._from_edges is not None:
        lines = [y for x in on_grids(self._fitted) for y in lines_of(x)]
        borders = [x for x in lines if isinstance(x, Segments) and x.border]
        found.append(AwayFrom.of(borders, reach._from_edges))
    conditions = [x for x in found if x is not None]
    if not reach._rays:
        return conditions
    if not isinstance(surface, Surface):
        raise InputError("what obstructs a ray is not known of splines: give the surface.")
    return [*conditions, *_free(surface, reach)]


def _free(whole: Part | Surface, reach: Reach) -> Iterator[Free]:
    """Yield the conditions on rays from points of a part or surface; InputError if it is open."""
    for axis, distance in reach._rays:
        obstacle = obstacle_of(whole)
        if not obstacle.closed:
            raise InputError(
                "what obstructs a ray needs a closed part or surface, and this one is open; faces "
                "of a closed part are chosen with part.select, or --faces."
            )
        yield Free(obstacle, axis, distance)


def borders_of(part: Part) -> list[Segments]:
    """Return all edges and boundaries of faces, except smooth seams of a face.

    If an edge has two sides, the curve of the side with the smaller error is taken. Faces without
    wires contribute their boundary polygons.
    """
    polygons = [x for x in boundaries_of(part) if not part.faces[x.face].wires]
    return [*(best for best, *_ in _by_edge(part)), *polygons]


def with_edges(part: Part) -> list[Segments]:
    """Return the boundary polygons of all faces, and the curves of the sides of all edges.

    Polygons deviate from the curves of the file, towards the inside of a face. Of two sides that
    have the same points, the one with the smaller error is returned.
    """
    found = boundaries_of(part)
    for best, *others in _by_edge(part):
        found += [best, *(x for x in others if not _same(best, x))]
    return found


def _same(one: Segments, other: Segments) -> bool:
    """Return whether the points of two sides of an edge are the same, up to rounding."""
    rows = np.arange(len(one.starts))
    a, b = (x.at(rows, np.zeros(len(rows)))[1] for x in (one, other))
    return bool(np.abs(a - b).max() <= ROUNDING * np.abs(a).max())


def _by_edge(part: Part) -> Iterator[list[Segments]]:
    """Yield the curves of the sides of each edge, the one with the smallest error first."""
    for _, sides in itertools.groupby(_sides(space_of(part, None)), lambda x: x[0]):
        yield sorted((x for _, x in sides), key=lambda x: np.max(x.errors))


def _sides(space: PartSpace) -> Iterator[tuple[int, Segments]]:
    """Yield the index of the edge and the curve of each side with known parameters.

    Smooth seams and degenerate edges are left out.
    """
    arrays, number = space.part.arrays, {x.face.index: k for k, x in enumerate(space.pieces)}
    places = np.split(arrays["side_points"], arrays["side_point_starts"][1:-1])
    for edge, (first, last) in enumerate(itertools.pairwise(arrays["edge_side_starts"].tolist())):
        faces = arrays["side_faces"][first:last].tolist()
        sides = [
            _cubics(space.pieces[number[face]], places[side])
            for side, face in zip(range(first, last), faces, strict=True)
            if face in number and len(places[side]) > 1 and np.isfinite(places[side]).all()
        ]
        if len(sides) == 2 and faces[0] == faces[1]:
            uv = np.concatenate([x.starts for x in sides], axis=1)
            both = sides_at(space, np.full((len(uv), 2), number[faces[0]]), uv)
            sides = sides if both.sharp.any() else []
        if not arrays["edge_degenerate"][edge]:
            yield from ((edge, x) for x in sides)


def _cubics(piece: FacePiece, points: Array) -> Segments:
    """Return the curve of a side of an edge, as cubics between points.

    `points` (k, 4) are u, v and their derivatives by a parameter of the edge from 0 to 1.
    """
    uv, slopes = points[:, :2], points[:, 2:] / (len(points) - 1)
    if piece.face.reversed:
        uv, slopes = own_parameters(piece.surface, uv, is_reversed=True), slopes * [-1.0, 1.0]
    steps, errors = np.diff(uv, axis=0), np.zeros(len(uv) - 1)
    if len(uv) > 2:
        off = uv[1:-1] - (uv[:-2] + uv[2:]) / 2.0 - (slopes[:-2] - slopes[2:]) / 4.0
        tangents = piece.jets(*uv[1:-1].T.copy())[:, 1:3]
        error = OF_COARSER * np.linalg.norm(np.einsum("ki,kix->kx", off, tangents), axis=1)
        errors[1:] = error
        errors[:-1] = np.maximum(errors[:-1], error)
    bends = np.stack([slopes[:-1] - steps, slopes[1:] - steps], axis=1)
    face = piece.face.index
    return Segments(piece, uv[:-1], steps, face, True, errors, bends, piece.domain)


def weights_of(part: Part, samples: Samples) -> Array:
    """Return the weights (N,) of samples: areas of the points to which a sample is the nearest one.

    Only points of the sample's own face count. On each face with samples, the weights add up to its
    area, or to the area of its part in the reach of the samples. Samples on edges, and samples that
    are not regular, have weight 0.
    """
    found, faces = np.zeros(len(samples)), samples.face_index
    if faces is None:
        raise MissingFieldError(
            "weights of a part need the field 'face_index', and these samples hold "
            f"{', '.join(samples.fields)} only."
        )
    on_edge = samples.other_face_index
    inner = samples._regular if on_edge is None else samples._regular & (on_edge < 0)
    space = reached(part, None, reach=samples.report._in_reach)
    points = space.scaled_points(samples.points)
    cells = space.uniform.cut(math.sqrt(space.area / (CELLS_A_SAMPLE * max(len(samples), 1))))
    for k, rows in runs(cells.pieces):
        piece = space.pieces[k]
        here = np.flatnonzero((faces == piece.face.index) & inner)
        if len(here):
            nearest = tree_of(points[here]).query(cells.rows[rows, :3])[1]
            shares = np.bincount(nearest, cells.numbers[rows, AREA], len(here))
            total = shares.sum()
            equal = np.full(len(here), 1.0 / len(here))
            found[here] = piece.area * (shares / total if total > 0.0 else equal)
    return found
