"""Surfaces and CAD parts as scenes, for pictures and pages, and the visibility of their points.

Matplotlib draws in three dimensions without a depth test. Here a point is hidden if a triangle of
a mesh of the surface lies between it and the viewer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError, SurfaceError
from ...runtime.directions.unit import unit_or_zero
from ...runtime.domain.trim import Trim
from ...runtime.fitting.fit import spline_of
from ...runtime.samples.samples import Samples
from ...runtime.spline.nets import AnySpline
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ..cad.face_pieces import FacePiece, pieces_of
from ..cad.part import Part
from ..meshes.front import Front, cross_of, in_front
from ..support.convolution import Convolution

Array = NDArray[np.float64]

VIEW = ELEVATION, AZIMUTH = 28.0, -55.0  # of the viewer, in degrees
MESH, MOST_MESH = 112, 224  # quadrangles along u and v: the number of cells, within these limits
ISOLINES = 16  # parameter lines along u and v
# A surface hides a sample if it is nearer to the viewer than the sample by at least this fraction
# of the diameter of the surface.
HIDING = 0.01
# Triangles of a part are divided until their longest side is the diameter divided by this number.
PIECES = 40
# A ratio of height to width below LOW or above HIGH is changed to about LOW_WANTED or HIGH_WANTED.
LOW, LOW_WANTED = 0.1, 0.25
HIGH, HIGH_WANTED = 10.0, 2.0
# The numbers of grid cells along u and along v: on planes, on other faces, and on faces of parts
# with more than MANY faces.
FLAT, CURVED, SMALL, MANY = 2, 40, 12, 60
SLIVER = 1e-9  # a triangle without an area, relative to the rectangle of parameters


def view(elevation: float = ELEVATION, azimuth: float = AZIMUTH) -> Array:
    """Return a matrix (3, 3) whose rows are the directions right, up, and towards the viewer.

    Elevation and azimuth of the viewer are in degrees.
    """
    angles = math.radians(elevation), math.radians(azimuth)
    s, c, S, C = (f(angle) for angle in angles for f in (math.sin, math.cos))
    return np.array([[-S, C, 0.0], [-s * C, -s * S, c], [c * C, c * S, s]])


@dataclass(frozen=True, eq=False)
class Scene:
    """A surface as quadrangles (Q, 4, 3) with lines on it; pictures multiply heights by `factor`.

    The corners of a quadrangle are in cyclic order. A triangle is a quadrangle with its last corner
    repeated; a part has triangles only. Each line is an array (k, 3). The rows of `view` are the
    directions right, up, and towards the viewer. `faces` (Q,) are the indices of the faces of a
    part to which the quadrangles belong.
    """

    quadrangles: Array
    lines: tuple[Array, ...] = ()
    factor: float = 1.0
    view: Array = field(default_factory=view)
    faces: NDArray[np.int64] | None = None

    def seen(self, points: Array) -> Array:
        """Return points (..., 3) by coordinates right, up, and towards the viewer.

        Heights are rescaled.
        """
        return (points * [1.0, 1.0, self.factor]) @ self.view.T

    @cached_property
    def triangles(self) -> Array:
        """The triangles (T, 3, 3), halves of quadrangles, in the coordinates of `seen`."""
        seen = self.seen(self.quadrangles)
        second = seen[(seen[:, 2] != seen[:, 3]).any(axis=1)]
        return np.concatenate([seen[:, [0, 1, 2]], second[:, [0, 2, 3]]])

    @cached_property
    def brightness(self) -> Array:
        """The brightness (Q,) of the quadrangles, 0 … 1; the light comes from the upper left."""
        a, b, c, d = np.moveaxis(self.seen(self.quadrangles), 1, 0)
        size = np.abs([c - a, d - b]).max() or 1.0
        normals = unit_or_zero(np.cross((c - a) / size, (d - b) / size))
        normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # both sides are lit
        lamp = np.array([-0.45, 0.6, 0.7])
        return np.clip(normals @ (lamp / np.linalg.norm(lamp)), 0.0, 1.0)

    @cached_property
    def visible_lines(self) -> Array:
        """The visible segments (k, 2, 3) of the lines."""
        if not self.lines:
            return np.empty((0, 2, 3))
        seen = self.visible(np.concatenate(self.lines))
        ends = np.cumsum([len(line) for line in self.lines])
        segments = np.concatenate([np.stack([x[:-1], x[1:]], axis=1) for x in self.lines])
        # Every point begins a segment, except the last point of each line.
        first = np.delete(np.arange(len(seen)), ends - 1)
        return segments[seen[first] & seen[first + 1]]

    def visible(self, points: Array) -> NDArray[np.bool_]:
        """Return which points (P, 3) of the surface are visible, as booleans (P,)."""
        seen = self.seen(points)
        nearest = Front.of(self.triangles).at(seen[:, :2])
        return np.asarray(seen[:, 2] >= nearest - HIDING * self._diameter)

    def in_layers(self) -> list[Scene]:
        """Return scenes to paint one over the other, since Matplotlib sorts by mean depth only.

        Sorting by mean depth suits the small quadrangles of a surface, which is one scene. The
        triangles of a part differ in size: they are divided, and hidden triangles are in the first
        scene, visible ones in the second.
        """
        if self.faces is None:
            return [self]
        small = divided(self.quadrangles[:, :3], self._diameter / PIECES)
        visible = in_front(self.seen(small))
        layers = (small[x][:, [0, 1, 2, 2]] for x in (~visible, visible) if x.any())
        return [replace(self, quadrangles=x, faces=None) for x in layers]

    @cached_property
    def _diameter(self) -> float:
        return float(np.linalg.norm(np.ptp(self.triangles.reshape(-1, 3), axis=0)))


def scene_of_samples(
    samples: Samples, surface: object = None, seen_from: Array | None = None
) -> Scene:
    """Return the scene of the surface of samples; InputError if the surface is unknown."""
    base = samples.offset_of
    if surface is None and isinstance(samples, Convolution):
        return _rescaled(_of_sums(samples), seen_from)
    for known in (surface, samples.spline, samples.surface):
        if known is not None:
            return scene_of(known, seen_from)
    if base is not None and (known := base.spline or base.surface) is not None:
        return scene_of(known, seen_from, base.distance)
    raise InputError(
        "these samples do not hold their surface (those from a file do not); give it, as in "
        "samples.plot(surface)."
    )


def scene_of(surface: object, seen_from: Array | None = None, distance: float = 0.0) -> Scene:
    """Return the scene of a surface or spline, of its offset, or of a part, with heights rescaled.

    Raises SurfaceError for a part without usable faces, InputError for any other object.
    """
    if isinstance(surface, Part):
        drawn, lines, faces = _of_part(surface)
    elif isinstance(surface, Surface | AnySpline):
        # Several pieces are drawn as one spline, which rounds the edges between them.
        (drawn, lines), faces = _of_spline(spline_of(surface, None), distance), None
    else:
        kind = type(surface).__name__
        raise InputError(f"surface must be a Surface, a Spline or a Part, not {kind}.")
    return _rescaled(drawn, seen_from, lines, faces)


def _rescaled(
    drawn: Array,
    seen_from: Array | None,
    lines: tuple[Array, ...] = (),
    faces: NDArray[np.int64] | None = None,
) -> Scene:
    """Return the scene of quadrangles and lines, with heights rescaled."""
    factor = height_factor(np.ptp(drawn.reshape(-1, 3), axis=0))
    return Scene(drawn, lines, factor, view() if seen_from is None else seen_from, faces)


def _of_sums(sums: Convolution) -> Array:
    """Return the triangles of the mesh of sums as quadrangles.

    Without a mesh, each point becomes a quadrangle with four equal corners.
    """
    try:
        mesh = sums.mesh(prefer="normals")
    except InputError:
        return np.repeat(sums.points[:, None], 4, axis=1)
    return mesh.vertices[mesh.triangles[:, [0, 1, 2, 2]]]


def _of_spline(spline: Spline, distance: float) -> tuple[Array, tuple[Array, ...]]:
    """Return quadrangles and parameter lines of a spline or its offset, inside the trim."""
    u, v, inside = _grid_inside(spline)
    mesh = spline.evaluate(u[:, None], v)
    if distance:
        mesh = mesh + distance * np.nan_to_num(spline.normals(u[:, None], v))
    beside = np.pad(inside, 1)  # a segment is drawn if a quadrangle beside it is drawn
    along_v = beside[1:, 1:-1] | beside[:-1, 1:-1]
    along_u = beside[1:-1, 1:] | beside[1:-1, :-1]
    lines = [
        line
        for side, there in ((mesh, along_v), (np.swapaxes(mesh, 0, 1), along_u.T))
        for k in np.linspace(0, len(side) - 1, ISOLINES + 1).round().astype(np.int64)
        for line in _parts(side[k], there[k])
    ]
    return quadrangles(mesh)[inside.ravel()], tuple(lines)


def _grid_inside(spline: Spline) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return values of u and v, and a mask (m, n) of the rectangles between them inside the trim.

    If a trim leaves only a small part of the domain, the grid covers this part only, with the usual
    number of lines.
    """
    counts = [min(max(MESH, count), MOST_MESH) for count in spline.cells]
    ends = np.array(spline.domain)
    u, v = (np.linspace(low, high, n + 1) for (low, high), n in zip(ends, counts, strict=True))
    if spline.trim is None:
        return u, v, np.ones((len(u) - 1, len(v) - 1), dtype=np.bool_)
    inside = _inside(spline.trim, u, v)
    if inside.any():
        for k, values in enumerate((u, v)):
            rows = np.flatnonzero(inside.any(axis=1 - k))
            ends[k] = values[max(rows[0] - 1, 0)], values[min(rows[-1] + 2, len(values) - 1)]
        u, v = (np.linspace(low, high, n + 1) for (low, high), n in zip(ends, counts, strict=True))
        inside = _inside(spline.trim, u, v)
    return u, v, inside if inside.any() else np.ones_like(inside)


def _inside(trim: Trim, u: Array, v: Array) -> NDArray[np.bool_]:
    """Return a mask of the rectangles between values of u and v whose centres are inside a trim."""
    centres = np.meshgrid(*((x[1:] + x[:-1]) / 2 for x in (u, v)), indexing="ij")
    return trim.contains(np.stack(centres, axis=-1).reshape(-1, 2)).reshape(centres[0].shape)


def _parts(line: Array, there: NDArray[np.bool_]) -> list[Array]:
    """Return the connected pieces of a line (k, 3) whose segments are in a mask (k − 1,)."""
    ends = np.flatnonzero(np.diff(np.pad(there, 1).astype(np.int8))).reshape(-1, 2)
    return [line[first : last + 1] for first, last in ends]


def _of_part(part: Part) -> tuple[Array, tuple[Array, ...], NDArray[np.int64]]:
    """Return triangles of a part, boundaries of its faces, and the face index of each triangle."""
    fine = SMALL if len(part) > MANY else CURVED
    pieces, _ = pieces_of(part.faces)
    if not pieces:
        raise SurfaceError(f"{part.name!r} has no face that can be drawn.")
    triangles, lines = zip(*(_of_face(piece, fine) for piece in pieces), strict=True)
    faces = np.repeat([x.face.index for x in pieces], [len(x) for x in triangles])
    drawn = np.concatenate(triangles)[:, [0, 1, 2, 2]]
    return drawn, tuple(x for some in lines for x in some), faces


def _of_face(piece: FacePiece, fine: int) -> tuple[Array, list[Array]]:
    """Return triangles (k, 3, 3) of a face, counterclockwise from outside, and its boundary."""
    from scipy.spatial import Delaunay

    surface, trim = piece.surface, piece.surface.trim
    low, high = np.array(surface.domain).T
    size = high - low
    loops = [np.clip(low + size * _divided((x - low) / size), low, high) for x in piece.polygons]
    across = FLAT if piece.face.kind == "plane" else fine
    grid = np.meshgrid(*np.linspace(low, high, across + 1).T, indexing="ij")
    places = np.stack(grid, axis=2).reshape(-1, 2)
    if trim is not None:
        inner = places[trim.contains(places)]
        places = np.unique(np.concatenate([inner, *(x[:-1] for x in loops)]), axis=0)
    scaled = (places - low) / size
    triangles = Delaunay(scaled, qhull_options="QJ Pp").simplices
    # Qhull joggles points, so that there are triangles almost without area along straight
    # boundaries.
    a, b, c = np.moveaxis(scaled[triangles], 1, 0)
    twice = cross_of(b - a, c - a)
    triangles = np.where(twice[:, None] < 0.0, triangles[:, ::-1], triangles)
    triangles = triangles[np.abs(twice) > SLIVER]
    if trim is not None:
        triangles = triangles[trim.contains(places[triangles].mean(axis=1))]
    return surface.evaluate(*places.T)[triangles], [surface.evaluate(*x.T) for x in loops]


def _divided(loop: Array) -> Array:
    """Return a polygon in the unit square with points added, closed by repeating the first point.

    There are about 4 × CURVED points, equally spaced between the corners of the polygon.
    """
    closed = np.concatenate([loop, loop[:1]])
    lengths = np.linalg.norm(np.diff(closed, axis=0), axis=1)
    counts = np.maximum(np.ceil(lengths * 4 * CURVED / max(lengths.sum(), 1e-300)), 1)
    corners = np.concatenate([[0.0], np.cumsum(counts)])
    return np.stack([np.interp(np.arange(corners[-1] + 1), corners, x) for x in closed.T], axis=1)


def divided(triangles: Array, longest: float) -> Array:
    """Divide triangles (T, 3, 3) into triangles (k, 3, 3) with no side longer than `longest`."""
    done = []
    while len(triangles):
        sides = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
        large = sides.max(axis=1) > longest
        done.append(triangles[~large])
        turns = (sides[large].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(triangles[large], turns[..., None], axis=1), 1, 0)
        middle = (a + b) / 2.0
        halves = np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)
        triangles = np.concatenate(halves)
    return np.concatenate(done)


def quadrangles(mesh: Array) -> Array:
    """Return the quadrangles (Q, 4, 3) of a mesh (m + 1, n + 1, 3), corners in cyclic order."""
    corners = mesh[:-1, :-1], mesh[1:, :-1], mesh[1:, 1:], mesh[:-1, 1:]
    return np.stack([x.reshape(-1, 3) for x in corners], axis=1)


def height_factor(extent: Array) -> float:
    """Return the factor of heights, which is 1 unless the surface is very flat or very high."""
    width, height = float(extent[:2].max()), float(extent[2])
    if LOW * width <= height <= HIGH * width or height <= 1e-9 * width or width <= 1e-9 * height:
        return 1.0
    if height < LOW * width:
        return _round(LOW_WANTED * width / height)
    return 1.0 / _round(height / (HIGH_WANTED * width))


def _round(factor: float) -> float:
    """Return the largest of …, 1, 2, 5, 10, 20, … that is not above a factor."""
    power = 10.0 ** math.floor(math.log10(factor))
    return power * max(digit for digit in (1, 2, 5) if digit * power <= factor * (1 + 1e-9))
