"""Points with given normals on edges where faces meet smoothly: only one face keeps each point.

The face of lowest index keeps it; of two points on the seam of a face, the first one is kept.
Likewise, only one face keeps a component, a curve or region of constant normal, that extends over
several faces; points of other faces at the ends of the component are left out.
"""

from dataclasses import replace
from operator import attrgetter

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.kept import kept
from ...runtime.onto_surface.proved import CODE
from ...runtime.samples.fields import Component
from ...runtime.samples.report import UndecidedNormal
from ...runtime.spline.joints import linked
from ..density.at_normals import Given, PieceSamples
from ..density.cells import grouped
from .edge_gaps import EdgeGaps, largest_radius
from .edges import Edges, at_places, between_two, edges_of
from .face_indices import GAP
from .part import Part
from .results import PartSpace

# Points with the same normal on connected faces count as one point if they are closer than SAME,
# relative to the size of the part, or closer than the distance over which normals change by twice
# the gap between faces, at most FAR. This is right since, near a smooth edge, no two points have
# the same normal and the same sign of K.
SAME, FAR = 1e-8, 1e-5
# Points are sorted by their coordinates along this direction. Few of these are equal, even on
# symmetric parts.
DIRECTION = np.array([0.52, 0.47, 0.71])
# The point of an edge where a face has a given normal is searched ROUNDS times among PLACES points,
# each time in an interval that is shorter by the factor ZOOM. The face has the normal if its normal
# at the point found differs by at most NEAR.
PLACES, ZOOM, ROUNDS, NEAR = 33, 4.0, 12, 1e-6
# The point of the edge counts as a point of a component if the box of the component contains it, up
# to this fraction of the domain.
SAME_PLACE = 1e-6


def each_once(space: PartSpace, given: Given) -> Given:
    """Return the points at normals, without the points that a face of lower index has as well.

    Where K changes its sign at the edge, the points of both faces are kept: nearby normals have two
    points or none. Points of edges with gaps wider than `GAP` are added.
    """
    part = space.pieces[0].face.part
    if not given.same_normals:
        return given
    given, alone = _with_gaps(space, given, EdgeGaps.of(part))
    seamed = kept(part, _have_seams, lambda: _have_seams(part))
    if len(space.pieces) < 2 and not seamed.any():
        return given
    points = given.array("points", np.float64)
    faces = np.array([x.face.index for x in space.pieces])[given.pieces]
    K, H = (given.array(x, np.float64) for x in ("gaussian_curvature", "mean_curvature"))
    normals = given.array("normal_index", np.int64)
    keys = np.stack(
        [normals, kept(part, each_once, lambda: _connected(part))[faces], np.signbit(K)]
    )
    along, size = points @ DIRECTION, space.size / space.unit
    slack = _reach(GAP, largest_radius(K, H), size)
    order = np.lexsort((along, *keys))
    ranks = faces * len(order) + np.arange(len(order))
    points, ranks, keys, along = points[order], ranks[order], keys[:, order], along[order]
    # Of one face, the points of a seam are those whose parameters are far apart.
    shares = given.array("uv", np.float64) / space.sizes[given.pieces] * seamed[faces][:, None]
    faces, shares = faces[order], shares[order]
    lost, slack, alone = np.zeros(len(order), dtype=np.bool_), slack[order], alone[order]
    for step in range(1, len(order)):
        near = (keys[:, step:] == keys[:, :-step]).all(axis=0)
        near &= along[step:] - along[:-step] <= slack.max()
        if not near.any():
            break
        first, second, apart = ranks[:-step], ranks[step:], points[step:] - points[:-step]
        near &= np.linalg.norm(apart, axis=1) <= np.maximum(slack[step:], slack[:-step])
        turned = (np.abs(shares[step:] - shares[:-step]) > 0.5).any(axis=1)
        near &= ((faces[:-step] != faces[step:]) | turned) & ~(alone[step:] & alone[:-step])
        lost[step:] |= near & (first < second)
        lost[:-step] |= near & (first > second)
    keep = np.ones(len(order), dtype=np.bool_)
    keep[order[lost]] = False
    keep &= _first_of_curves(space, given, keep)
    return replace(given, found=tuple(sorted(_kept(given, keep), key=attrgetter("piece"))))


def _kept(given: Given, keep: Flags) -> list[PieceSamples]:
    """Return the samples that `keep` (N,) marks."""
    ends = np.cumsum([len(x.samples) for x in given.found])[:-1]
    parts = np.split(keep, ends) if given.found else ()
    return [
        x if y.all() else x._replace(samples=x.samples[y])
        for x, y in zip(given.found, parts, strict=True)
    ]


def _reach(gap: Array | float, radius: Array, size: float) -> Array:
    """Return the distance over which normals change by twice a gap.

    It is at least SAME and at most FAR times the size.
    """
    return np.fmin(np.maximum(2.0 * gap * radius, SAME * size), FAR * size)


def _with_gaps(space: PartSpace, given: Given, gaps: EdgeGaps | None) -> tuple[Given, Flags]:
    """Add the points of edges with gaps; also return a mask of points known to be distinct.

    Points that the search beyond the sides of a face found in a gap are left out. Normals beside
    corners are undecided.
    """
    count = len(given)
    keep, distinct = np.ones(count, np.bool_), np.zeros(count, np.bool_)
    at = None if gaps is None else gaps.at(given.normals)
    if gaps is None or at is None or len(at.numbers) == 0:
        return given, distinct
    numbered = {x.face.index: k for k, x in enumerate(space.pieces)}
    whole = np.array([numbered.get(x.face.index, -1) for x in gaps.space.pieces])
    pieces, size = whole[at.pieces], space.size / space.unit
    regular = given.array("component", np.float64) == Component.REGULAR
    points, normals = given.array("points", np.float64), given.array("normal_index", np.int64)
    keys = normals * len(space.pieces) + given.pieces
    order = np.argsort(keys, kind="stable")
    radius = largest_radius(*np.moveaxis(at.curvatures, 2, 0))
    reach, far = (_reach(x, radius, size) for x in (2.0 * at.gaps[:, None], gaps.slack))
    settled = at.settled & ~gaps.beside_corners(at.points, far.max(axis=1))
    is_inside = at.pieces[:, 0] == at.pieces[:, 1]
    for k, side in np.argwhere((pieces >= 0) & settled[:, None]).tolist():
        key = at.numbers[k] * len(space.pieces) + pieces[k, side]
        rows = order[slice(*np.searchsorted(keys[order], [key, key + 1]))]
        away = np.linalg.norm(points[rows] - at.points[k], axis=1)
        rows = rows[regular[rows] & (away <= reach[k, side])]
        distinct[rows] = True
        if not is_inside[k]:
            keep[rows] = at.has[k, side]
    side = np.where(pieces < 0, len(space.pieces), pieces).argmin(axis=1)
    owner, uv = pieces[np.arange(len(side)), side], at.uv[np.arange(len(side)), side]
    for k, rows in grouped(np.where(is_inside, owner, -1)):
        owner[rows] = np.where(space.pieces[k].contains(uv[rows]) | (k < 0), owner[rows], -1)
    (rows,) = np.nonzero((owner >= 0) & settled & at.between)
    found = _kept(given, keep)
    for k, own in grouped(owner[rows]):
        piece, some = space.pieces[k], rows[own]
        places = np.zeros((len(some), 7))
        places[:, :2], places[:, 4], places[:, CODE] = (
            uv[some], at.signs[some], Component.CREASE
        )  # fmt: skip
        samples = piece.samples_of(given.normals, at.numbers[some], places)
        if piece.reach is not None:
            samples = samples[piece.reach._holds(samples.points, samples.normals)]
        found.append(PieceSamples(k, samples, given.normals))
    for k in np.flatnonzero((owner >= 0) & ~settled).tolist():
        piece = space.pieces[owner[k]]
        (u0, v0), (u1, v1) = ((uv[k] + x * FAR * piece.sizes).tolist() for x in (-1.0, 1.0))
        corner = UndecidedNormal(
            int(at.numbers[k]), (u0, u1, v0, v1), "open", True, piece.face.index
        )
        nothing = piece.samples_of(given.normals, at.numbers[:0], np.empty((0, 7)), [corner])
        found.append(PieceSamples(int(owner[k]), nothing, given.normals))
    given = replace(given, found=tuple(found))
    return given, np.append(distinct[keep], np.ones(len(given) - keep.sum(), np.bool_))


def _first_of_curves(space: PartSpace, given: Given, keep: Flags) -> Flags:
    """Return a mask of the points at normals to keep: one point for each component.

    Curves and regions on several faces that meet at edges, and points on edges that meet them, are
    one component.
    """
    component, normals = given.array("component", np.float64), given.array("normal_index", np.int64)
    curves = np.flatnonzero(keep & (component == Component.CURVE))
    if len(curves) == 0:
        return keep
    rows = np.flatnonzero(keep & np.isin(normals, normals[curves]))
    edges, first = edges_of(space), np.ones(len(keep), np.bool_)
    # Pairs of an edge and a normal that both faces of the edge have, at least one of them on a
    # curve.
    has, of_curves = np.zeros((2, len(space.pieces), len(given.normals)), np.bool_)
    has[given.pieces[rows], normals[rows]] = True
    of_curves[given.pieces[curves], normals[curves]] = True
    one, other = edges.pieces.T
    owner, number = np.nonzero(has[one] & has[other] & (of_curves[one] | of_curves[other]))
    places, distances = _places_with(edges, owner, given.normals[number])
    links = [np.empty((0, 2), np.int64)]
    uv, radius = given.array("uv", np.float64), given.array("uv_radius", np.float64)
    for k in np.flatnonzero((distances <= NEAR).all(axis=1)):
        here = rows[normals[rows] == number[k]]
        sides = []
        for side, piece in enumerate(edges.pieces[owner[k]].tolist()):
            mine, sizes = here[given.pieces[here] == piece], space.sizes[piece]
            away = np.abs(uv[mine] - places[k, side])
            turned = np.array([x[0] == "periodic" for x in space.pieces[piece].surface.boundary])
            away = np.where(turned, np.minimum(away, np.abs(sizes - away)), away)
            sides.append(mine[(away <= radius[mine] + SAME_PLACE * sizes).all(axis=1)])
        links.append(np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2))
    one, other = np.concatenate(links).T
    group = linked(len(keep), one, other)[1]
    order = np.lexsort((given.pieces, component != Component.CURVE, group))
    first[order[1:]] = np.diff(group[order]) > 0
    return keep & first


def _places_with(edges: Edges, owner: Indices, normals: Array) -> tuple[Array, Array]:
    """Find the positions on edges (k,) where the normals of both faces are closest to given ones.

    Return the parameters (k, 2, 2) on both faces, and the lengths (k, 2) of the differences of
    their normals from `normals` (k, 3).
    """
    half = np.tile((np.diff(edges.starts) - 1.0)[owner, None, None] / 2.0, (1, 2, 1))
    middle, last, steps = half, 2.0 * half, np.linspace(-1.0, 1.0, PLACES)
    for _ in range(ROUNDS):
        at = np.clip(middle + half * steps, 0.0, last)
        best = _compared(edges, owner, normals, at)[1].argmin(axis=2)[..., None]
        middle, half = np.take_along_axis(at, best, axis=2), half / ZOOM
    uv, away = _compared(edges, owner, normals, middle)
    return uv[:, :, 0], away[:, :, 0]


def _compared(edges: Edges, owner: Indices, normals: Array, at: Array) -> tuple[Array, Array]:
    """Compare the normals of both faces of edges (k,) with `normals` (k, 3).

    Each face has its own positions `at` (k, 2, m) on the edge. Return the parameters (k, 2, m, 2)
    there, and the lengths (k, 2, m) of the differences of normals.
    """
    count, _, m = at.shape
    both = edges.at(np.repeat(owner, 2 * m), at.ravel()).reshape(count, 2, m, 2, 2)
    uv = np.stack([both[:, side, :, side] for side in (0, 1)], axis=1)
    pieces = np.repeat(edges.pieces[owner].ravel(), m)
    found = at_places(edges.space, pieces, uv.reshape(-1, 2)).normals.reshape(count, 2, m, 3)
    return uv, np.linalg.norm(found - normals[:, None, None], axis=3)


def _have_seams(part: Part) -> Flags:
    """Return whether faces (F,) meet themselves along an edge."""
    found, faces = np.zeros(len(part), np.bool_), between_two(part, seams=True)[0]
    found[faces[faces[:, 0] == faces[:, 1], 0]] = True
    return found


def _connected(part: Part) -> Indices:
    """Return the index of the connected component of each face, (F,)."""
    arrays = part.arrays
    starts, faces = arrays["edge_side_starts"], arrays["side_faces"]
    first = faces[np.repeat(starts[:-1], np.diff(starts))]
    return linked(len(part), first, faces)[1]
