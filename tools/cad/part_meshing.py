"""Meshes of parts: edges first, then the interior of faces, then triangles.

All vertices and edges are sampled once, and shared by the adjacent faces. The greedy cover of
`sample` adds vertices in the interior of faces. Each face is triangulated in a plane of its
parameters, scaled by its mean lengths, and edges are flipped in space.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.errors import GaussmapWarning, InputError, SurfaceError
from ...runtime.base.extras import check_extra
from ...runtime.base.memory import check_memory
from ...runtime.base.progress import tell
from ...runtime.base.wording import plural
from ...runtime.samples.samples import Samples
from ..density.cells import Cells, runs
from ..density.cover import Cover
from ..density.filling import Filling, target_of
from ..density.grid import Grid
from ..density.request import Request, checked_request
from ..density.space import Space
from ..meshes.creased import mean_normals
from ..meshes.kernels.flips import flip_edges
from ..meshes.links import edge_numbers, neighbours
from ..meshes.mesh import scaled
from ..meshes.triangulated import ENOUGH, LARGEST_DEVIATION, checked_prefer
from .edges import Places, at_places
from .mesh_edges import MeshEdges, SampledEdges
from .mesh_faces import EXTRA, Crossing, FaceBorder, triangles_of
from .mesh_grading import graded
from .mesh_smoothing import smoothed
from .mesh_spacing import ByNormals, Spacing
from .part import Part
from .part_mesh import PartMesh
from .records import NO_AREA
from .results import PartSpace, space_of

# Where a face has no normal, the normal is taken at this fraction of the way into the triangle.
INSIDE = 1e-6
# Edges are divided until triangles are valid, or ROUNDS times; vertices outside of the polygons
# around faces are replaced in at most REFILLS rounds.
ROUNDS, REFILLS = 15, 8
# If a mesh has faults, larger counts are tried: each MORE times the one before, up to MANY times
# the least count of the edges. The error names the first count whose mesh has no faults.
MORE, MANY = 1.2, 16
# The largest number of solids that an error names.
MOST_NAMED = 3
# The target densities of samples that the vertices of a mesh can follow.
DENSITIES = ("balanced", "uniform")
SPACINGS = {"shape": Spacing, "normals": ByNormals}


def mesh_of_samples(samples: Samples, angle: float | None, prefer: str) -> PartMesh:
    """Return the mesh of samples of a part, as `Samples.mesh` does."""
    spaced, part = SPACINGS[checked_prefer(prefer)], samples.surface
    assert isinstance(part, Part)
    if angle is not None:
        raise InputError(
            "an angle that triangles deviate by is for meshes of surfaces, not of CAD parts."
        )
    density = samples.report.density or "balanced"
    if density not in DENSITIES and spaced.by_shape:
        raise InputError(
            'a mesh of a CAD part follows the density "balanced" or "uniform", and these samples '
            f'have "{density}"; use one of these, or prefer normals.'
        )
    density = "uniform" if density == "uniform" and spaced.by_shape else "balanced"
    return mesh_of_part(part, len(samples), density, spaced, refuse=True)


def mesh_of_part(
    part: Part,
    count: int,
    density: str = "balanced",
    spaced: type[Spacing] = Spacing,
    *,
    refuse: bool = False,
) -> PartMesh:
    """Return a mesh of a part with `count` vertices.

    With `refuse`, raise InputError if the mesh has faults, and a larger count gives a mesh without
    faults.
    """
    check_extra(*EXTRA)
    check_memory("mesh", count)
    if not any(x.wires for x in part.faces):
        raise InputError(
            f"part {part.name!r} does not say how its edges go around its faces; read the CAD "
            "file again."
        )
    _check_apart(part)
    whole = space_of(part, None, target_of(request_of(count, density)))
    if whole.target.curvature_weight > 0.0 and spaced.exponent != whole.target.exponent:
        whole = whole.to_power(spaced.exponent)
    known = MeshEdges.of(Spacing(whole, count))
    failed = {k: why for k, why in whole.failed.items() if part.faces[k].reason != NO_AREA} | {
        x.face.index: f"{x.label} has edges whose parameters on it are not known."
        for x in whole.pieces
        if not known.is_known(x.face)
    }
    made: tuple[PartMesh, bool] | SurfaceError
    try:
        made = mesh_and_soundness(whole, count, failed, spaced)
    except SurfaceError as error:
        made = error
    if refuse and (isinstance(made, SurfaceError) or not made[1]):
        _check_larger(whole, count, MANY * known.least, failed, spaced)
    if isinstance(made, SurfaceError):
        raise made
    mesh, is_proper = made
    faults = list[str]()
    if failed := mesh.failed:
        faults.append(
            f"lacks {plural(len(failed), 'face')} of {len(part):,}: {next(iter(failed.values()))}"
        )
    if refuse and not is_proper and len(rows := inverted_triangles(mesh)):
        faults.append(_inward(mesh, whole, rows))
    for text in faults:
        warnings.warn(f"the mesh of part {part.name!r} {text}", GaussmapWarning, stacklevel=5)
    return mesh


def _check_apart(part: Part) -> None:
    """Raise InputError if solids share edges, which then have more than two sides."""
    faces, starts = part.arrays["side_faces"], part.arrays["edge_side_starts"]
    pairs = (
        np.repeat(np.arange(len(starts) - 1), np.diff(starts)),
        part.arrays["solid_index"][faces],
    )
    edges, solids = np.unique(np.stack(pairs), axis=1)
    shared = solids[np.isin(edges, edges[1:][np.diff(edges) == 0]) & (solids >= 0)]
    named = [f"{k} {part.solids[k].name!r}" for k in np.unique(shared).tolist()]
    if len(named) > 1:
        more = ", …" if len(named) > MOST_NAMED else ""
        raise InputError(
            f"{len(named)} solids of part {part.name!r} share faces or edges "
            f"({', '.join(named[:MOST_NAMED])}{more}): mesh each by itself, "
            "selected by the indices of its faces."
        )


def _inward(mesh: PartMesh, whole: PartSpace, rows: Indices) -> str:
    """Return the text of a warning about triangles that point inward, with the first one's face."""
    face = mesh.face_index[rows[0]]
    label = next(x.label for x in whole.pieces if x.face.index == face)
    return (
        f"has {plural(len(rows), 'triangle')} pointing inward, the first one on {label}, and "
        "no larger count is known to be without them; repair the face in a CAD program, or leave "
        "it out."
    )


def mesh_and_soundness(
    whole: PartSpace, count: int, failed: Mapping[int, str], spaced: type[Spacing]
) -> tuple[PartMesh, bool]:
    """Return a mesh, and whether it is sound: no triangle points inward, and no face is missing.

    Faces in `failed` were missing from the beginning, and do not count.
    """
    lacking = dict(failed)
    while True:
        meshing = Meshing.of(whole, count, lacking, spaced)
        bad = meshing.refine()
        if not bad:
            try:
                mesh, bad = meshing.mesh()
            except Crossing as error:  # after rounding
                bad = {error.face: f"of face {error.face}, {error}."}
            else:
                if not bad:
                    return mesh, len(lacking) == len(failed) and not len(inverted_triangles(mesh))
        lacking |= bad


def _check_larger(
    whole: PartSpace, count: int, most: int, failed: Mapping[int, str], spaced: type[Spacing]
) -> None:
    """Raise InputError if a larger count, below `most`, gives a mesh without faults."""
    larger = math.ceil(MORE * count)
    while larger < most:
        with suppress(SurfaceError):  # no face has triangles
            if mesh_and_soundness(whole, larger, failed, spaced)[1]:
                raise InputError(
                    f"a mesh of part {whole.part.name!r} with {count:,} vertices would lack faces, "
                    f"or have triangles that point inward; {larger:,} are enough."
                )
        larger = math.ceil(MORE * larger)


def request_of(count: int, density: str) -> Request:
    """Return the request for a number of samples with a target density."""
    return checked_request(None, count, None, None, density, None)


@dataclass(frozen=True, eq=False)
class Corners:
    """The triangles (T, 3) of all faces, as indices of corners; each corner (C,) is on one face.

    `pieces` (C,) are the indices of the pieces of the corners, `numbers` (C,) the indices of their
    vertices, and `known` their parameters and fields. `fixed` (m, 2) are pairs of corners: segments
    that edge flips must not remove.
    """

    pieces: Indices
    numbers: Indices
    known: Places
    triangles: Indices
    fixed: Indices

    def improved(
        self, space: PartSpace, points: Array, first: int, by_shape: bool
    ) -> tuple[Corners, Array]:
        """Improve the triangles by edge flips; return the corners, and their points (C, 3).

        Flips bring the triangles closer to the normals. With `by_shape`, the shape of triangles is
        improved first, by flips and by moves of the vertices with indices from `first` on; then
        flips bring triangles closer to the normals where no angle becomes small. Triangles at
        corners without a normal, as at apexes, stay.
        """
        count, normals = len(self.pieces), self.known.normals
        triangles = self.triangles.copy()
        adjacent = neighbours(triangles, np.ones(count, dtype=np.bool_))[0]
        numbers = edge_numbers(triangles, count)
        without = ~np.asarray(normals.any(axis=1))[triangles].all(axis=1)
        stay = np.concatenate([np.sort(self.fixed, axis=1) @ [count, 1], numbers[without].ravel()])
        adjacent[np.isin(numbers, stay)] = -1

        def flip(normals: Array, by_shape: bool, least: float) -> None:
            flip_edges(
                scaled(points), normals, triangles, np.ones_like(triangles), adjacent, by_shape,
                least, np.arange(len(triangles)), np.ones(len(triangles), dtype=np.bool_),
            )  # fmt: skip

        known, least = self.known, math.cos(math.radians(LARGEST_DEVIATION))
        if by_shape:
            flip(normals, True, least)
            free = self.numbers >= first
            known, points = smoothed(space, self.pieces, known, triangles, points, free)
            flip(known.normals, True, least)
        flip(known.normals, False, math.tan(math.radians(ENOUGH)) if by_shape else 0.0)
        return replace(self, known=known, triangles=triangles), points

    def normals(self, space: PartSpace, triangles: Indices) -> Array:
        """Return unit normals (T, 3, 3) at the corners of triangles.

        If the face has no normal at a corner, because a parameter line is collapsed to a point, the
        normal is taken inside the triangle: midway between the other two corners in the parameter
        of that line, and close to the corner in the other parameter.
        """
        uv, found = self.known.uv, self.known.normals[triangles]
        rows, corner = np.nonzero(~found.any(axis=2))
        at = triangles[rows, corner]
        toward = (uv[triangles[rows]].sum(axis=1) - uv[at]) / 2.0
        lengths = np.linalg.norm(self.known.vectors[at, 1:], axis=2) * space.sizes[self.pieces[at]]
        ways = np.where(lengths == lengths.min(axis=1, keepdims=True), 1.0, INSIDE)
        inside = uv[at] + ways * (toward - uv[at])
        found[rows, corner] = at_places(space, self.pieces[at], inside).normals
        return found


@dataclass(frozen=True, eq=False)
class Meshing:
    """A mesh of a part under construction; `failed` are the missing faces, with reasons."""

    edges: MeshEdges
    failed: dict[int, str]

    @property
    def space(self) -> PartSpace:
        """The space of the pieces that are meshed."""
        return self.edges.space

    @property
    def count(self) -> int:
        """The number of vertices."""
        return self.edges.spacing.count

    @classmethod
    def of(
        cls, whole: PartSpace, count: int, failed: dict[int, str], spaced: type[Spacing]
    ) -> Meshing:
        """Return the start of a mesh of the pieces of a space that have not failed."""
        pieces = tuple(x for x in whole.pieces if x.face.index not in failed)
        if not pieces:
            reason = next(iter(failed.values()))
            raise SurfaceError(f"no face of part {whole.part.name!r} can be meshed: {reason}")
        held = whole._held if len(pieces) == len(whole.pieces) else {}
        made: Space = replace(whole, pieces=pieces, _held=held)
        if whole.target.curvature_weight > 0.0:
            request = request_of(count, "balanced")
            made = Filling(made, request, False, lambda number: None).balanced(capped=True)
        else:
            made = made.between(1.0)
        assert isinstance(made, PartSpace)
        edges = MeshEdges.of(spaced(made, count))
        if spaced.by_shape and edges.least <= count:
            edges = MeshEdges.of(spaced(graded(edges), count))
        return cls(edges, failed)

    def refine(self) -> dict[int, str]:
        """Divide edges until the boundary of no face crosses itself.

        Return the faces whose boundaries still cross themselves: a text for each, by face index.
        """
        crossing = self._crossing()
        while crossing:
            sampled = self._sampled()
            owner = np.unique(np.concatenate([border.edges for _, border, _ in crossing]))
            all_of = {
                k: np.ones(len(sampled.shares[k]) - 1, dtype=np.bool_) for k in owner.tolist()
            }
            if not self._refine(sampled, all_of):
                break
            crossing = self._crossing()
        return {k: text for k, _, text in crossing}

    def _crossing(self) -> list[tuple[int, FaceBorder, str]]:
        """Return index, boundary and error text of each face whose boundary crosses itself."""
        found = []
        for k, border in enumerate(self._borders(self._sampled())):
            piece, even = self.space.pieces[k], np.ones((len(border.uv), 2, 3))
            try:
                triangles_of(border, self.edges.spacing.plane(k, border.uv, even))
            except Crossing as error:
                found.append((piece.face.index, border, f"of {piece.label}, {error}."))
        return found

    def mesh(self) -> tuple[PartMesh, dict[int, str]]:
        """Return the mesh, and the reasons why faces have failed, by face index.

        A face fails at edges with too few or too many triangles. Such edges, and edges near
        triangles that point inward, are divided as long as that helps.
        Raises Crossing if the boundary of a face crosses itself.
        """
        best, least, wrong_of_best = None, (0, 0), np.empty((0, 2), dtype=np.int64)
        for _ in range(ROUNDS):
            sampled = self._sampled()
            try:
                mesh = self._made(sampled)
            except Crossing:
                if best is None:
                    raise
                break
            wrong, inverted = wrong_edges(sampled, mesh, self.edges), inverted_triangles(mesh)
            around = mesh.triangles[inverted][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
            if best is None or (len(wrong), len(inverted)) < least:
                best, least, wrong_of_best = mesh, (len(wrong), len(inverted)), wrong
            coarse = _between(np.concatenate([wrong, around]), sampled)
            if not coarse or not self._refine(sampled, coarse):
                break
        assert best is not None
        return _without_unused(best), self._faces_at(best, wrong_of_best)

    def _faces_at(self, mesh: PartMesh, wrong: Indices) -> dict[int, str]:
        """Return the faces that have a triangle with one of the `wrong` edges (k, 2).

        The result is a dict of reasons by face index.
        """
        count = len(mesh.vertices)
        at = np.isin(edge_numbers(mesh.triangles, count), np.sort(wrong, axis=1) @ [count, 1])
        faces = np.unique(mesh.face_index[at.any(axis=1)]).tolist()
        text = "triangles share edges with those of other faces; take more samples."
        return {
            x.face.index: f"of {x.label}, {text}"
            for x in self.space.pieces
            if x.face.index in faces
        }

    def _refine(self, sampled: SampledEdges, segments: dict[int, Flags]) -> bool:
        """Split edge segments while vertices remain; return True if any was split."""
        before, least = dict(self.edges.more), self.edges.least
        self.edges.refine(sampled, segments)
        if least < self.edges.least <= self.count:
            return True
        self.edges.more = before
        return False

    def _sampled(self) -> SampledEdges:
        if self.edges.least > self.count:
            raise InputError(
                f"a mesh of part {self.space.part.name!r} needs at least {self.edges.least:,} "
                f"vertices for its edges, and there are {self.count:,} samples; take more."
            )
        return self.edges.sampled()

    def _borders(self, sampled: SampledEdges) -> list[FaceBorder]:
        return [FaceBorder.of(x, sampled) for x in self.space.pieces]

    def _made(self, sampled: SampledEdges) -> PartMesh:
        """Return a mesh whose edges may still have a wrong number of triangles.

        The vertices on edges come first, as in `sampled`. Interior vertices are replaced if they
        are outside the boundary polygons, or in a triangle that points inward.
        """
        borders = self._borders(sampled)
        cover = self._cover(sampled, borders)
        first, left_out = len(sampled.points), np.empty(0, dtype=np.int64)
        mesh = None
        for _ in range(REFILLS):
            added = cover.added[cover.fixed :] if cover else self.space.nothing()
            chosen = np.setdiff1d(np.arange(len(added)), left_out)
            corners = self._corners(borders, added[chosen], first + chosen)
            mesh = self._mesh(sampled, corners)
            bad = np.unique(mesh.triangles[inverted_triangles(mesh)])
            left_out = np.union1d(left_out, bad[bad >= first] - first)
            used = np.setdiff1d(mesh.triangles, bad)
            lacking = self.count - first - int(np.count_nonzero(used >= first))
            if lacking <= 0 or cover is None:
                break
            cover.renew_distances(cover.radius)
            cover.fill_up(cover.count + lacking)
        assert mesh is not None
        return mesh

    def _cover(self, sampled: SampledEdges, borders: list[FaceBorder]) -> Cover | None:
        """Cover faces by vertices: vertices on edges are given, interior vertices are added.

        Returns None if all faces are ruled, and have no interior samples.
        """
        space, numbers = self.edges.spacing.covered
        if not len(numbers):
            return None
        pieces = np.repeat(np.arange(len(numbers)), [len(borders[k].uv) for k in numbers])
        places = [borders[k].uv for k in numbers]
        cells = space.at(pieces, np.concatenate(places))
        cells = cells[np.asarray(cells.rows[:, 3:6].any(axis=1))]
        none = np.full(len(cells), -1)
        cover = Cover(space, grid=Grid(cells, none, none, (0, 0)))
        inside = self.count - len(sampled.points)
        tell("placing vertices", lambda: cover.count / (len(cells) + inside))
        if inside:
            cover.spread(len(cells) + inside)
        return cover

    def _corners(self, borders: list[FaceBorder], added: Cells, names: Indices) -> Corners:
        """Return the triangles between vertices on edges and interior vertices.

        `names` are the vertex indices of the interior vertices `added`.
        """
        order = np.argsort(added.pieces, kind="stable")
        cells, spacing = added[order], self.edges.spacing
        cells = replace(cells, pieces=spacing.covered[1][cells.pieces]) if len(cells) else cells
        rows = dict(runs(cells.pieces))
        inner = [cells.places[rows.get(k, slice(0, 0))] for k in range(len(borders))]
        numbers = [names[order[rows.get(k, slice(0, 0))]] for k in range(len(borders))]
        counts = [len(x.uv) + len(y) for x, y in zip(borders, inner, strict=True)]
        pieces, starts = np.repeat(np.arange(len(borders)), counts), np.cumsum([0, *counts])
        both = zip(borders, inner, strict=True)
        known = at_places(
            self.space, pieces, np.concatenate([x for b, y in both for x in (b.uv, y)])
        )
        triangles, fixed = [], []
        for k, border in enumerate(borders):
            tell("triangulating faces", lambda done=k: done / len(borders))
            tangents = known.vectors[starts[k] : starts[k + 1], 1:]
            places = spacing.plane(k, np.concatenate([border.uv, inner[k]]), tangents)
            try:
                found, segments = triangles_of(border, places)
            except Crossing as error:
                error.face = self.space.pieces[k].face.index
                raise
            triangles.append(starts[k] + found)
            fixed.append(starts[k] + segments)
        tell("flipping edges")
        at = np.concatenate(
            [x for b, y in zip(borders, numbers, strict=True) for x in (b.numbers, y)]
        )
        found = np.concatenate(triangles)
        a, b, c = at[found].T  # at a pole, two corners may be one vertex
        proper = (a != b) & (b != c) & (c != a)
        return Corners(pieces, at, known, found[proper], np.concatenate(fixed))

    def _mesh(self, sampled: SampledEdges, corners: Corners) -> PartMesh:
        count = max(int(corners.numbers.max()) + 1, len(sampled.points))
        points, uv, first = np.zeros((count, 3)), np.zeros((count, 2)), len(sampled.points)
        at, by_shape = corners.known.vectors[:, 0].copy(), self.edges.spacing.by_shape
        on_edges = corners.numbers < first
        at[on_edges] = sampled.points[corners.numbers[on_edges]]
        corners, at = corners.improved(self.space, at, first, by_shape)
        points[corners.numbers], points[:first] = at, sampled.points
        uv[corners.numbers[::-1]] = corners.known.uv[::-1]
        triangles = corners.triangles
        vertices, normals = corners.numbers[triangles], corners.normals(self.space, triangles)
        faces, nothing = [x.face.index for x in self.space.pieces], np.empty(0, dtype=np.int64)
        part, is_point = self.space.part, self.edges.arrays["edge_degenerate"].tolist()
        lines = [nothing if x else sampled.numbers.get(k, nothing) for k, x in enumerate(is_point)]
        return PartMesh(
            points, mean_normals(vertices, normals, count), uv, vertices,
            np.full(count, -1), part.name,
            corner_normals=normals, face_index=np.array(faces)[corners.pieces[triangles[:, 0]]],
            lines=tuple(lines), failed=self.failed, unit=part.unit,
        )  # fmt: skip


# --- faults ---------------------------------------------------------------------------------------


def wrong_edges(sampled: SampledEdges, mesh: PartMesh, edges: MeshEdges) -> Indices:
    """Return the edges of a mesh that have a wrong number of triangles, as vertex pairs (k, 2).

    The right number is two or, along an edge of the part, the number of its adjacent faces.
    """
    count = len(mesh.vertices)
    numbers, times = np.unique(edge_numbers(mesh.triangles, count), return_counts=True)
    along, sides = [np.empty((0, 2), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    for edge, line in enumerate(mesh.lines):
        if len(line):
            along.append(np.sort(np.stack([line[:-1], line[1:]], axis=1), axis=1))
            sides.append(np.full(len(line) - 1, edges.around[edge]))
    segments, rows = np.unique(np.concatenate(along) @ [count, 1], return_index=True)
    wanted = np.concatenate(sides)[rows]
    expected = np.full(len(numbers), 2)
    at = np.searchsorted(segments, numbers)
    on = at < len(segments)
    on[on] = segments[at[on]] == numbers[on]
    expected[on] = wanted[at[on]]
    lost = segments[~np.isin(segments, numbers)]
    found = np.concatenate([numbers[times != expected], lost])
    return np.stack(np.divmod(found, count), axis=1)


def inverted_triangles(mesh: PartMesh) -> Indices:
    """Return the indices (k,) of triangles that point away from the mean normal of their corners.

    Triangles that point away from the normal of a single corner are allowed: a face of a file may
    fold over at its boundary.
    """
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    return np.flatnonzero(np.einsum("tx,tkx->t", across, mesh.corner_normals) < 0.0)


def _between(pairs: Indices, sampled: SampledEdges) -> dict[int, Flags]:
    """Find the segments of edges of the part between the two vertices of each of the pairs (k, 2).

    Return masks of the segments, by index of the edge.
    """
    at: dict[int, dict[int, list[int]]] = {x: {} for x in np.unique(pairs).tolist()}
    for edge, line in sampled.numbers.items():
        for place in np.flatnonzero(np.isin(line, pairs)).tolist():
            at[int(line[place])].setdefault(edge, []).append(place)
    found: dict[int, Flags] = {}
    for a, b in pairs.tolist():
        for edge in at[a].keys() & at[b].keys():
            places = [sorted(x) for x in itertools.product(at[a][edge], at[b][edge])]
            low, high = min(places, key=lambda x: x[1] - x[0])
            nothing = np.zeros(len(sampled.numbers[edge]) - 1, dtype=np.bool_)
            found.setdefault(edge, nothing)[low:high] = True
    return found


def _without_unused(mesh: PartMesh) -> PartMesh:
    """Return a mesh without the vertices that no triangle uses."""
    used = np.zeros(len(mesh.vertices), dtype=np.bool_)
    used[mesh.triangles] = True
    new = np.cumsum(used) - 1
    return replace(
        mesh, vertices=mesh.vertices[used], normals=mesh.normals[used], uv=mesh.uv[used],
        triangles=new[mesh.triangles], sample_index=mesh.sample_index[used],
        lines=tuple(new[x] if used[x].all() else x[:0] for x in mesh.lines),
    )  # fmt: skip
