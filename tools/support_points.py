"""Support points: the farthest points of a surface in given directions.

A farthest point in the direction n has the normal n or −n, or lies on a boundary. `GaussMap.points`
finds all points with these normals, with a proof if possible; on a boundary, n·x is maximized along
short segments. Six support points give the bounding box of a surface.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..runtime.base.aliases import Array, Flags, Indices
from ..runtime.base.errors import SurfaceError
from ..runtime.base.kept import kept
from ..runtime.directions.unit import as_normals
from ..runtime.domain.domain import Domain, brought_inside
from ..runtime.domain.trim import Trim, polygons_of
from ..runtime.map import GaussMap, kept_map
from ..runtime.onto_surface.on_spline import OnPatches, OnSpline, on_grids
from ..runtime.samples.report import UndecidedNormal
from ..runtime.samples.whole import Whole
from ..runtime.search.search import developable_patches
from ..runtime.spline.joints import EDGES
from ..runtime.spline.kernels.patch import count_developable
from ..runtime.spline.missing import Known
from ..runtime.spline.nets import NetSpline
from ..runtime.spline.spline import Spline
from ..runtime.spline.tips import tips_of
from ..runtime.surface.surface import Surface
from .meshes.border import border_lines
from .meshes.places import on_side, uv_at, wrapped

# Sides of the domain are cut into this number of segments for each cell.
STEPS_A_CELL = 2
# A set of directions is halved until it is a single direction, or has at most PAIRS pairs of a
# direction and a segment that may be farthest in this direction.
PAIRS = 1 << 13
# The numbers of steps of Newton's method, and of bisection where the boundary of a trim crosses a
# segment.
STEPS, BISECTIONS = 6, 50
# Newton's method starts at these positions in undecided boxes.
IN_BOXES = (np.indices((3, 3)).reshape(2, -1).T + 0.5) / 3.0
# Whether a side is inside the trim is tested at this distance from it, relative to the domain.
BESIDE = 1e-8
# Bound of the rounding error of n·x, relative to the largest coordinate.
ROUNDING = 32.0 * np.finfo(np.float64).eps


class SupportPoints(NamedTuple):
    """The farthest points of a surface in S directions.

    Attributes
    ----------
    points : (S, 3) float64 array
        For each direction n, scaled to unit length, a point x with the largest n·x.
    values : (S,) float64 array
        The values n·x there: the support function of the convex hull.
    errors : (S,) float64 array
        Bounds of the differences from the largest values. They are rounding errors if all points
        with the normals n and −n are proved to be known; in undecided boxes, they include the last
        step of Newton's method. On edges of parts, they include the estimated deviations of cubics
        from the curves of the file. Without a proof, they follow from the measured distance of the
        spline from the surface (`Misfit.distance`). If a face of a part has no proof, all of them
        are infinite.
    uv : (S, 2) float64 array
        The parameters of the points; NaN on splines of nets.
    face_index : (S,) int64 array
        For a part: the indices of the faces. −1 for other surfaces.
    on_border : (S,) bool array
        Whether the point was found on a boundary of the surface, of a face or of a net; False for a
        tip that was found as a point with this normal (`gm.Component`).

    Examples
    --------
    >>> import gaussmap as gm
    >>> found = gm.GaussMap("torus").support([[0, 0, 2], [1, 0, 0]])
    >>> found.values.round(12), abs(found.points[1]).round(12), found.uv.shape
    (array([0.35, 1.35]), array([1.35, 0.  , 0.  ]), (2, 2))
    >>> bool(found.errors.max() < 1e-13), found.on_border.any(), found.face_index
    (True, np.False_, array([-1, -1]))

    """

    points: Array
    values: Array
    errors: Array
    uv: Array
    face_index: Indices
    on_border: Flags

    @classmethod
    def nothing(cls, count: int) -> SupportPoints:
        """Return the state before any point is known: values −∞ in `count` directions."""
        return cls(
            np.full((count, 3), np.nan), np.full(count, -np.inf), np.zeros(count),
            np.full((count, 2), np.nan), np.full(count, -1), np.zeros(count, np.bool_),
        )  # fmt: skip

    def add(
        self, owner: Indices, normals: Array, points: Array, uv: Array | None,
        faces: Indices | int = -1, border: Flags | bool = False, errors: Array | float = 0.0,
    ) -> None:  # fmt: skip
        """Replace known points by given points (k, 3) that are farther in their directions.

        `owner` (k,) are the indices of the directions of the given points; `normals` (S, 3) are all
        directions. Of equally far points the first one is taken.
        """
        values = np.einsum("kx,kx->k", points, normals[owner])
        order = np.lexsort((-values, owner))
        order = order[np.isfinite(values[order])]
        order = order[np.diff(owner[order], prepend=-1) != 0]
        order = order[values[order] > self.values[owner[order]]]
        given = (points, values, errors, np.nan if uv is None else uv, faces, border)
        for mine, new in zip(self, given, strict=True):
            mine[owner[order]] = new[order] if isinstance(new, np.ndarray) else new


def support(self: GaussMap, directions: ArrayLike) -> SupportPoints:
    """Return the farthest point of the surface in each direction, wherever it lies.

    The farthest point is a point with this normal or the opposite one, a point of a boundary, a
    corner, or a tip. If all points of a curve or a region are farthest, one of these points is
    returned, always the same one. The values are those of the support function of the convex hull.

    Parameters
    ----------
    directions : (S, 3) array_like
        Directions of any length but 0.

    Returns
    -------
    SupportPoints
        The points, the values n·x, and bounds of their errors. The boundary is that of the trim:
        loops are polygons, and the boundary of a predicate is a polyline through points on it.
        Faces of parts are bounded by their edges; only where a file has none, by `Face.loops`.

    Raises
    ------
    InputError
        For unusable directions.
    SurfaceError
        If no point of the surface is finite.

    See Also
    --------
    points : all points with given normals.

    Examples
    --------
    >>> import gaussmap as gm
    >>> half = gm.surfaces.torus().trimmed(within=lambda u, v: u < 3)
    >>> found = gm.GaussMap(half).support([[0, 1, 0], [0, -1, 0]])
    >>> found.values.round(6), found.on_border
    (array([1.35, 0.  ]), array([False,  True]))

    """
    normals = as_normals(directions)
    found = _farthest(self, normals)
    if not np.isfinite(found.values).all():
        name = getattr(self.surface, "name", "surface")
        raise SurfaceError(f"{name!r} has no farthest point: no point inside its trim is finite.")
    rounding = ROUNDING * np.linalg.norm(found.points, axis=1)
    for curves in _curves_of(self):
        np.maximum(rounding, curves.rounding, out=rounding)
    return found._replace(errors=found.errors + rounding)


def bounds_of(self: Surface | Whole) -> Array:
    """Return the smallest and the largest coordinates (2, 3) of a surface or a part."""
    gauss_map = kept_map(self) if isinstance(self, Surface) else GaussMap(self)
    values = support(gauss_map, np.concatenate([-np.eye(3), np.eye(3)])).values
    return values.reshape(2, 3) * [[-1.0], [1.0]] + 0.0


def _farthest(gauss_map: GaussMap, normals: Array) -> SupportPoints:
    """Return the farthest points in unit directions (S, 3); errors do not include rounding."""
    count, surface = len(normals), gauss_map.surface
    found = SupportPoints.nothing(count)
    fields = ["points", "uv", "normal_index"] + ["face_index"] * isinstance(surface, Whole)
    samples = gauss_map.points(np.concatenate([normals, -normals]), fields=fields)
    faces = -1 if samples.face_index is None else samples.face_index.astype(np.int64)
    uv = None if isinstance(gauss_map.spline, NetSpline) else samples.uv
    found.add(samples.normal_index % count, normals, samples.points, uv, faces)
    report = samples.report
    _add_undecided(found, gauss_map, normals, report.undecided or ())
    for bounds in [x.add(found, normals) for x in _curves_of(gauss_map)]:
        more = np.flatnonzero(bounds > found.values)
        found.errors[more] = np.maximum(found.errors[more], bounds[more] - found.values[more])
    if report.estimated_faces:
        found.errors[:] = np.inf
    elif report.proved is None and report.on == "surface":
        _compare_with_splines(found, gauss_map, normals)
    return found


def _compare_with_splines(found: SupportPoints, gauss_map: GaussMap, normals: Array) -> None:
    """Raise the `errors` of known points to bounds that the splines of the surface give.

    First, the points of the surface at the parameters of the farthest points of the splines are
    added. The bound is then the largest n·x on a spline, plus the distance of the spline from the
    surface, minus the value n·x of the known point.
    """
    on_splines = [(x, _farthest(kept_map(x.spline), normals)) for x in on_grids(gauss_map._fitted)]
    for piece, near in on_splines:
        points = piece.jets(*near.uv.T.copy())[:, 0]
        points = np.where(np.isfinite(points), points, near.points)
        found.add(np.arange(len(normals)), normals, points, near.uv, -1, near.on_border)
    for piece, near in on_splines:
        bounds = near.values + piece.distance - found.values
        np.maximum(found.errors, bounds, out=found.errors)


# --- boundaries -----------------------------------------------------------------------------------


class HasJets(Protocol):
    """A surface, a piece or a face."""

    def jets(self, u: Array, v: Array) -> Array:
        """Return the 2-jets (k, 6, 3) at parameters."""
        ...


@dataclass(frozen=True, eq=False)
class Segments:
    """M segments `starts` + t `steps` (M, 2) of the parameters of a surface, 0 ≤ t ≤ 1.

    With `bends` (M, 2, 2) the segments are cubic curves; `bends` are their derivatives at both
    ends, less the steps. The tangent of each segment in space is assumed to turn by less than half
    a turn. `face` is the index of the face of a part, and `border` is False for lines inside a
    surface. The boundary is within `errors` (M,) of the segments in space. Parts of segments
    outside a `domain` count for bounds only.
    """

    surface: HasJets
    starts: Array
    steps: Array
    face: int = -1
    border: bool = True
    errors: Array | float = 0.0
    bends: Array | None = None
    domain: Domain | None = None

    def at(self, rows: Indices, t: Array) -> tuple[Array, Array, Array, Array]:
        """Return u, v (k, 2) and x, dx/dt, d²x/dt² (k, 3) at t (k,) on the segments `rows` (k,)."""
        t, steps = t[:, None], self.steps[rows]
        uv, bend = self.starts[rows] + t * steps, np.zeros_like(steps)
        if self.bends is not None:
            first, last = self.bends[rows, 0], self.bends[rows, 1]
            tilt, total = (1.0 - t) * first - t * last, first + last
            uv += t * (1.0 - t) * tilt
            steps = steps + (1.0 - 2.0 * t) * tilt - t * (1.0 - t) * total
            bend = -2.0 * (tilt + (1.0 - 2.0 * t) * total)
        if isinstance(self.surface, OnSpline):
            spline = self.surface.spline
            u, v = uv.T
            uv = np.stack(brought_inside(u, v, spline.domain, spline.boundary), axis=1)
        x, xu, xv, xuu, xuv, xvv = np.moveaxis(self.surface.jets(*uv.T.copy()), 1, 0)
        du, dv = steps[:, :1], steps[:, 1:]
        turning = du * (du * xuu + 2.0 * dv * xuv) + dv * dv * xvv
        return uv, x, du * xu + dv * xv, turning + bend[:, :1] * xu + bend[:, 1:] * xv


@dataclass(frozen=True, eq=False)
class NetEdges:
    """The M edges of nets: quadratic Bézier curves with control points (M, 3, 3)."""

    control: Array
    face = -1
    border = True
    errors = 0.0
    bends = None

    def at(self, rows: Indices, t: Array) -> tuple[Array, Array, Array, Array]:
        """Return NaN for u, v, and x, dx/dt, d²x/dt² (k, 3), at t (k,) on the edges `rows` (k,)."""
        a, b, c = np.moveaxis(self.control[rows], 1, 0)
        s = t[:, None]
        ab, bc = a + s * (b - a), b + s * (c - b)
        nowhere = np.full((len(rows), 2), np.nan)
        return nowhere, ab + s * (bc - ab), 2.0 * (bc - ab), 2.0 * (c - 2.0 * b + a)


@dataclass(frozen=True, eq=False)
class Curves:
    """M segments of one or more surfaces, with the points and tangents (M, 2, 3) at both ends.

    A segment is given by the index of its part in `parts` and its row there. The boundary is within
    `errors` (M,) of the segments, and is assumed to be within `reach` (M,) of their starts.
    """

    parts: Sequence[Segments | NetEdges]
    part: Indices
    row: Indices
    points: Array
    tangents: Array
    errors: Array
    reach: Array
    rounding: float

    @classmethod
    def of(cls, parts: Sequence[Segments | NetEdges]) -> Curves:
        """Return the segments of all parts whose points and tangents at both ends are finite."""
        rows = [np.arange(len(x.starts if isinstance(x, Segments) else x.control)) for x in parts]
        part = np.repeat(np.arange(len(parts)), [len(x) for x in rows])
        row = np.concatenate([np.empty(0, np.int64), *rows])
        points, tangents = np.empty((len(part), 2, 3)), np.empty((len(part), 2, 3))
        for k, x in enumerate(parts):
            for t in (0, 1):
                at = x.at(rows[k], np.full(len(rows[k]), float(t)))
                points[part == k, t], tangents[part == k, t] = at[1:3]
        off = (x.errors + np.zeros(len(y)) for x, y in zip(parts, rows, strict=True))
        errors = np.concatenate([np.empty(0), *off])
        finite = np.isfinite(points).all(axis=(1, 2)) & np.isfinite(tangents).all(axis=(1, 2))
        part, row, points, tangents = part[finite], row[finite], points[finite], tangents[finite]
        errors = errors[finite]
        rounding = ROUNDING * np.abs(points).max(initial=0.0)
        reach = np.linalg.norm(points[:, 1] - points[:, 0], axis=1) + errors + rounding
        return cls(parts, part, row, points, tangents, errors, reach, rounding)

    def add(self, found: SupportPoints, normals: Array) -> Array:
        """Replace known points by points of segments that are farther in the directions (S, 3).

        Return upper bounds (S,) of n·x on the boundary where it is farther than known points.
        """
        bounds = np.full(len(normals), -np.inf)
        near = self._near(found, normals) if len(self.part) else ()
        pairs = [self._highest(found, normals, some, rows) for some, rows in near]
        if not pairs:
            return bounds
        owner, rows, t = map(np.concatenate, zip(*pairs, strict=True))
        order = np.argsort(self.part[rows], kind="stable")
        numbers, firsts = np.unique(self.part[rows[order]], return_index=True)
        for k, some in zip(numbers, np.split(order, firsts[1:]), strict=True):
            part = self.parts[k]
            here = self.row[rows[some]]
            most = _add_highest(part, found, normals, owner[some], here, t[some])
            np.maximum.at(bounds, owner[some], most)
        return bounds

    def _near(self, found: SupportPoints, normals: Array) -> Iterator[tuple[Indices, Indices]]:
        """Yield indices of a few directions, and of the segments that may be farthest in them.

        Let the directions be within δ of a vector a. A segment cannot be farthest if its start is
        lower along a than a known point, by more than the `reach` of the segment plus δ times the
        distance between start and point.
        """
        halves = [(np.arange(len(normals)), np.arange(len(self.part)))]
        while halves:
            some, rows = halves.pop()
            n = normals[some]
            mean = n.mean(axis=0)
            apart = np.linalg.norm(n - mean, axis=1).max()
            starts = self.points[rows, 0]
            known = np.concatenate([starts, found.points[some]])
            starts = starts - known[np.nanargmax(known @ mean)]
            above = starts @ mean + self.reach[rows] + apart * np.linalg.norm(starts, axis=1)
            rows = rows[above >= 0.0]
            if len(some) * len(rows) > PAIRS and len(some) > 1:
                order = some[n[:, np.ptp(n, axis=0).argmax()].argsort(kind="stable")]
                halves += [(x, rows) for x in np.array_split(order, 2)]
            elif len(rows):
                yield some, rows

    def _highest(
        self, found: SupportPoints, normals: Array, some: Indices, rows: Indices
    ) -> tuple[Indices, Indices, Array]:
        """Return indices of directions (k,) and of segments (k,) that may be highest in them.

        Also return t (k,), near the highest point of each segment.
        """
        n = normals[some].T[:, :, None]
        ends, slopes = (
            x[0] * n[0] + x[1] * n[1] + x[2] * n[2]
            for x in (y[rows].T[:, :, None] for y in (self.points, self.tangents))
        )
        inside = (slopes[0] > 0.0) & (slopes[1] < 0.0)
        # A concave curve is below its tangents; twice the slopes allow for other curves.
        most = (ends + np.array([2.0, -2.0])[:, None, None] * slopes).min(axis=0)
        most += self.errors[rows]
        highest = ends.max(axis=0)
        best = np.fmax(highest.max(axis=1), found.values[some])
        owner, peaks = np.nonzero(inside & (most >= best[:, None] + self.rounding / 4.0))
        slopes = slopes[:, owner, peaks]
        highest = highest.argmax(axis=1)
        ends = ends[:, np.arange(len(some)), highest]
        return (
            some[np.concatenate([np.arange(len(some)), owner])],
            rows[np.concatenate([highest, peaks])],
            np.concatenate([ends[1] > ends[0], slopes[0] / (slopes[0] - slopes[1])]),
        )


def _add_highest(
    part: Segments | NetEdges, found: SupportPoints, normals: Array,
    owner: Indices, rows: Indices, t: Array,
) -> Array:  # fmt: skip
    """Replace known points by the highest points of segments if these are farther.

    Segment rows[i] is considered in the direction owner[i]; its highest point is near t[i]. Return
    bounds (k,) of n·x on the boundary there. Points outside a domain are replaced by points at the
    nearest parameters inside.
    """
    n, steps, inside = normals[owner], np.zeros(len(t)), (t > 0.0) & (t < 1.0)
    for _ in range(STEPS):
        some = np.flatnonzero(inside)
        if not len(some):
            break
        _, _, d, dd = part.at(rows[some], t[some])
        slope, bend = (np.einsum("kx,kx->k", x, n[some]) for x in (d, dd))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(bend < 0.0, -slope / bend, 0.0)
        moved = np.clip(t[some] + step, 0.0, 1.0)
        inside[some] = moved != t[some]
        t[some], steps[some] = moved, np.abs(slope * step)
    uv, points, _, _ = part.at(rows, t)
    off = part.errors[rows] if isinstance(part.errors, np.ndarray) else part.errors
    if part.bends is not None:  # cubics, whose errors are 0 at their ends and largest at t = 1/2
        off = off * 4.0 * t * (1.0 - t)
    bounds = np.einsum("kx,kx->k", points, n) + off
    if isinstance(part, Segments) and part.domain is not None:
        uv = np.clip(uv, *np.array(part.domain).T)
        points = part.surface.jets(*uv.T.copy())[:, 0]
    errors = off + np.where(inside, steps, 0.0)
    found.add(owner, normals, points, uv, part.face, part.border, errors)
    return bounds


def _curves_of(gauss_map: GaussMap) -> list[Curves]:
    """Return the boundaries of the surface, and lines on which other farthest points may lie."""
    if isinstance(gauss_map.surface, Whole):
        part = gauss_map.surface
        return [kept(part, support, lambda: Curves.of(part._boundaries()))]
    return [
        kept(x.spline, ("support points", x.on), lambda x=x: Curves.of(list(lines_of(x))))
        for x in gauss_map._fitted
    ]


def lines_of(geometry: OnPatches) -> Iterator[Segments | NetEdges]:
    """Yield the boundary of a geometry, and edges of patches on which farthest points may lie.

    These are all edges of nets, and the edges of developable regions of other splines.
    """
    if not isinstance(geometry, OnSpline):
        rows = [[x.start, x.middle, x.end] for x in EDGES]
        assert isinstance(geometry.spline, NetSpline)
        yield NetEdges(geometry.spline.control_nets[:, rows].reshape(-1, 3, 3))
        return
    spline, sizes = geometry.spline, np.ptp(geometry.spline.domain, axis=1)
    for axis, ends in enumerate(spline.boundary):
        t = np.linspace(0.0, 1.0, STEPS_A_CELL * spline.cells[1 - axis] + 1)
        for place, end in enumerate(ends):
            if end == "open":
                uv = uv_at(spline, on_side(axis, float(place), t))
                inwards = np.array([1 - axis, axis]) * (BESIDE, -BESIDE)[place] * sizes
                yield _inside(geometry, uv[:-1], np.diff(uv, axis=0), inwards)
    if spline.trim is not None:
        yield from (_of_trim(geometry, x) for x in border_lines(spline))
    if geometry.on == "spline":
        yield _inside(geometry, *_edges_of_flat(spline), np.zeros(2), border=False)


def _of_trim(geometry: OnSpline, line: Array) -> Segments:
    """Return the segments of a polyline (k, 2) in the unit square, a boundary of the trim.

    If the trim has a predicate, the boundary is known only at the points of the polyline. The
    `errors` are then the distances of these points from the chords between their neighbours.
    """
    spline, middles = geometry.spline, (line[1:] + line[:-1]) / 2.0
    around = wrapped(middles, spline.boundary)
    low, high = np.array(spline.domain).T
    starts = low + (around + line[:-1] - middles) * (high - low)
    found = Segments(geometry, starts, np.diff(line, axis=0) * (high - low))
    parts = () if spline.trim is None else spline.trim.parts
    if len(starts) < 3 or all(polygons_of(x) or isinstance(x, Known) for x in parts):
        return found
    points = found.at(np.arange(len(starts)), np.zeros(len(starts)))[1]
    chords, steps = points[2:] - points[:-2], np.diff(points, axis=0)[:-1]
    squares = np.maximum(np.einsum("kx,kx->k", chords, chords), np.finfo(np.float64).tiny)
    along = np.einsum("kx,kx->k", steps, chords) / squares
    off = np.linalg.norm(steps - along[:, None] * chords, axis=1)
    off = np.pad(off, (2, 3), "edge")  # at the ends of a segment and of its two neighbours
    return replace(found, errors=np.lib.stride_tricks.sliding_window_view(off, 4).max(axis=1))


def _inside(
    geometry: OnSpline, starts: Array, steps: Array, inwards: Array, border: bool = True
) -> Segments:
    """Return the parts of segments that are inside the trim.

    The trim is tested at points moved by `inwards` (2,).
    """
    trim = geometry.spline.trim
    if trim is None:
        return Segments(geometry, starts, steps, border=border)

    def contains(t: Array) -> Flags:
        return trim.contains(starts + t[:, None] * steps + inwards)

    def crossing(out: Array, inner: Array) -> Array:
        """Return the parameters t where the segments enter the trim, by bisection."""
        for _ in range(BISECTIONS):
            middle = (out + inner) / 2.0
            is_in = contains(middle)
            out, inner = np.where(is_in, out, middle), np.where(is_in, middle, inner)
        return inner

    ends = np.array([[0.0], [0.5], [1.0]]) * np.ones(len(starts))
    known = np.array([contains(t) for t in ends])
    some = np.take_along_axis(ends, known.argmax(axis=0)[None], axis=0)[0]
    low, high = (np.where(known[k], ends[k], crossing(ends[k], some)) for k in (0, 2))
    kept_ = known.any(axis=0)
    starts, steps = starts + low[:, None] * steps, (high - low)[:, None] * steps
    return Segments(geometry, starts[kept_], steps[kept_], border=border)


def _edges_of_flat(spline: Spline) -> tuple[Array, Array]:
    """Return the edges of developable regions: starts and steps (k, 2) of the parameters.

    On a developable patch, critical points of n·x form lines, which end on edges. Patches at tips
    have no samples either, and are treated like developable patches.
    """
    flat, tips = _developable(spline), tips_of(spline)
    flat = flat.reshape(*spline.cells, 4)
    if tips is not None:
        flat |= tips.collapsed.reshape(flat.shape)
    beside = [(1, 1), (-1, 0), (-1, 1), (1, 0)]  # shifts of cells along an axis
    across = [np.roll(flat[..., (k + 2) % 4], *beside[k]) for k in range(4)]
    others = [np.stack(across, axis=-1), np.roll(flat, -1, axis=-1)]
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)])
    u0, v0, du, dv = spline.frame
    starts, steps = list[Array](), list[Array]()
    for other, from_centre in zip(others, (False, True), strict=True):
        i, j, turn = np.nonzero(flat != other)
        first, last = corners[4 if from_centre else turn], corners[(turn + 1) % 4]
        starts.append((u0, v0) + (np.stack([i, j], axis=1) + first) * (du, dv))
        steps.append((last - first) * (du, dv))
    return np.concatenate(starts), np.concatenate(steps)


def _developable(spline: Spline) -> Flags:
    """Return whether patches are developable.

    Ranges of patches are bisected: only the number of developable patches in a range is known.
    """
    flat, ranges = np.zeros(spline.patches, np.bool_), [(0, spline.patches)]
    while ranges and developable_patches(spline, None):
        first, last = ranges.pop()
        number = count_developable(spline.coefficients, spline.scale, spline.noise, first, last)
        if number == last - first:
            flat[first:last] = True
        elif number:
            middle = (first + last) // 2
            ranges += [(first, middle), (middle, last)]
    return flat


# --- normals with undecided points ----------------------------------------------------------------


def _add_undecided(
    found: SupportPoints, gauss_map: GaussMap, normals: Array, places: Sequence[UndecidedNormal]
) -> None:
    """Replace known points by farther points that Newton's method finds in undecided boxes.

    Such boxes cover, for example, a circle of points with the same normal.
    """
    if not places:
        return
    repeated = [x for x in places for _ in IN_BOXES]
    owner = np.array([x.normal for x in repeated]) % len(normals)
    boxes = np.array([x.box for x in repeated]).reshape(-1, 2, 2)
    starts = boxes[:, :, 0] + np.tile(IN_BOXES, (len(places), 1)) * np.ptp(boxes, axis=2)
    for surface, domain, trim, face in _surfaces(gauss_map):
        low, high = np.array(domain).T
        here = ((starts >= low) & (starts <= high)).all(axis=1)
        here &= np.array([x.face is None or x.face == face for x in repeated])
        n, (low, high) = normals[owner[here]], np.moveaxis(boxes[here], 2, 0)
        uv, sizes = starts[here], high - low
        errors = np.zeros(len(n))
        for _ in range(STEPS):
            jets = np.einsum("kjx,kx->kj", surface.jets(*uv.T.copy()), n)
            slopes = jets[:, 1:3] * sizes
            bends = jets[:, [3, 4, 4, 5]].reshape(-1, 2, 2) * sizes[:, :, None] * sizes[:, None]
            steps = -np.einsum("kij,kj->ki", np.linalg.pinv(bends, 1e-6, hermitian=True), slopes)
            errors, uv = np.abs(slopes * steps).sum(axis=1), np.clip(uv + steps * sizes, low, high)
        points = surface.jets(*uv.T.copy())[:, 0]
        kept_ = np.ones(len(n), np.bool_) if trim is None else trim.contains(uv)
        rows = np.flatnonzero(here)[kept_]
        found.add(owner[rows], normals, points[kept_], uv[kept_], face, errors=errors[kept_])


def _surfaces(gauss_map: GaussMap) -> Iterator[tuple[HasJets, Domain, Trim | None, int]]:
    """Yield the surfaces of a map, with their domains, trims, and the indices of faces or −1."""
    if isinstance(gauss_map.surface, Whole):
        for x in gauss_map.surface._space(None).pieces:
            yield x, x.domain, x.trim, x.face.index
    for x in gauss_map._fitted:
        if isinstance(x, OnSpline):
            yield x, x.spline.domain, x.spline.trim, -1
