"""Parabolic points of quadratic patches: straight lines in the parameter plane."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import reduce
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import gaussian_image as formulas
from ...generated import patch as patch_formulas
from ...generated.vectors import Vector
from ...runtime.base.tolerances import CUBIC_ERROR, DOUBLE_ROOT, PARAMETER_ERROR, VANISHING
from .patches import Patches, checked_control_points

Array = NDArray[np.float64]
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class ParabolicLine:
    """A line s u + t v + ρ = 0 of parabolic points that share a normal, with s² + t² = 1.

    Attributes
    ----------
    s, t, rho : float
        The coefficients of the line in the barycentric parameters u, v of the patch.
    normal : (3,) float64 array
        The unit normal, oriented as in the middle of `segment` or, if this is None, at the point
        of the line nearest to the middle of the triangle.
    multiplicity : int
        1 where the curvature changes its sign across the line, 2 where it touches zero, 3 where all
        three lines coincide.
    segment : (2, 2) float64 array or None
        The ends (u, v) of the part in the triangle u, v, 1 − u − v ≥ 0; None if that is empty.

    Examples
    --------
    >>> import gaussmap as gm
    >>> net = gm.fit("torus", (8, 8)).control_nets[6]
    >>> line, = gm.gauss_map.parabolic_lines(net)
    >>> line.normal.round(6) + 0.0, line.multiplicity  # the upper of the two circles K = 0
    (array([0., 0., 1.]), 1)
    >>> u, v = line.segment[0]
    >>> bool(abs(line.s * u + line.t * v + line.rho) < 1e-12)
    True

    """

    s: float
    t: float
    rho: float
    normal: Array
    multiplicity: int
    segment: Array | None = field(repr=False)


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex part of the parameter triangle without parabolic points inside.

    Attributes
    ----------
    corners : (k, 2) float64 array
        Its corners (u, v), counter-clockwise.
    sign : int
        The sign of the Gaussian curvature: 1 elliptic, −1 hyperbolic, 0 flat or developable.

    Examples
    --------
    >>> import gaussmap as gm
    >>> piece, = gm.gauss_map.split_patch(gm.fit("torus", (8, 8)).control_nets[0])
    >>> piece.corners.shape, piece.sign
    ((3, 2), 1)

    """

    corners: Array = field(repr=False)
    sign: int


def parabolic_lines(control_points: ArrayLike) -> tuple[ParabolicLine, ...]:
    """Return the parabolic lines of one quadratic patch (paper, Sect. 3.2), at most three.

    Parameters
    ----------
    control_points : (6, 3) array_like
        The control points in the order b200, b020, b002, b110, b101, b011.

    Returns
    -------
    tuple of ParabolicLine
        The lines, also those outside the triangle. A patch that is developable or planar up to the
        rounding of its coordinates has none, since all its points are parabolic; see
        `classify_patches`.

    Raises
    ------
    InputError
        For control points that are not six finite points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> net = gm.fit("torus", (8, 8)).control_nets[0]
    >>> len(gm.gauss_map.parabolic_lines(net)) <= 3
    True

    """
    return lines_of(Patches.of_control_points(checked_control_points(control_points)[None]))


def split_patch(control_points: ArrayLike) -> tuple[Piece, ...]:
    """Return the pieces into which the parabolic lines split a patch (paper, Sect. 3.2).

    Parameters
    ----------
    control_points : (6, 3) array_like
        The control points in the order b200, b020, b002, b110, b101, b011.

    Returns
    -------
    tuple of Piece
        Pieces on each of which K has one sign; together they are the parameter triangle. A
        developable patch is one piece of the sign 0.

    Raises
    ------
    InputError
        For control points that are not six finite points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> net = gm.fit("torus", (8, 8)).control_nets[0]
    >>> all(piece.sign in (-1, 0, 1) for piece in gm.gauss_map.split_patch(net))
    True

    """
    return pieces_of(Patches.of_control_points(checked_control_points(control_points)[None]))


def lines_of(patch: Patches) -> tuple[ParabolicLine, ...]:
    """Return the parabolic lines of one patch."""
    if patch.flat[0]:
        return ()
    lines = []
    for s, t, multiplicity in _directions(patch):
        line = _line(patch, s, t)
        if line is not None:
            rho, normal = line
            segment = _segment(s, t, rho)
            normal = _oriented(patch, s, t, rho, normal, segment)
            lines.append(ParabolicLine(s, t, rho, normal, multiplicity, segment))
    return tuple(lines)


def pieces_of(patch: Patches) -> tuple[Piece, ...]:
    """Return the pieces of the parameter triangle of one patch in which K has one sign."""
    polygons = [TRIANGLE]
    for line in lines_of(patch):
        if line.segment is not None:
            halves = [
                clipped(polygon, sign * np.array([line.s, line.t, line.rho]))
                for polygon in polygons
                for sign in (1.0, -1.0)
            ]
            polygons = [half for half in halves if half is not None]
    if patch.flat[0]:
        return (Piece(TRIANGLE, 0),)
    return tuple(Piece(polygon, _sign_in(patch, polygon)) for polygon in polygons)


def clipped(polygon: Array, line: Array) -> Array | None:
    """Return the part of a convex polygon (k, 2) where line · (u, v, 1) ≥ 0.

    Return None if this part has no interior.
    """
    heights = _heights(polygon, line)
    if heights.max() <= 0.0:
        return None
    corners = []
    for k in range(len(polygon)):
        here, before = heights[k], heights[k - 1]
        if here * before < 0.0:
            corners.append(polygon[k] + (polygon[k - 1] - polygon[k]) * (here / (here - before)))
        if here >= 0.0:
            corners.append(polygon[k])
    return np.array(corners) if len(corners) > 2 else None


def _heights(places: Array, line: Array) -> Array:
    """Return line · (u, v, 1) at points (k, 2), and 0 where it is zero up to rounding."""
    heights = places @ line[:2] + line[2]
    return np.where(np.abs(heights) <= PARAMETER_ERROR * (1.0 + abs(line[2])), 0.0, heights)


def singular_points(patch: Patches) -> Array:
    """Return the parameters (k, 2) at which N(u,v) vanishes: where two parabolic lines meet.

    Such a point may be the real intersection of two complex lines. A patch has at most three,
    unless all its parabolic lines coincide.
    """
    angle, roots = _roots(patch)
    c, s = math.cos(angle), math.sin(angle)
    lines = [_row(patch, x * c - s, x * s + c)[0] for x in roots]
    found: list[Array] = []
    for meeting in (np.cross(*pair) for pair in combinations(lines, 2)):
        with np.errstate(divide="ignore", invalid="ignore"):
            place = meeting[:2] / meeting[2]
        if np.isfinite(place).all() and np.abs(place.imag).max() <= DOUBLE_ROOT:
            found.append(_singular_point(patch, place.real))
    places = [x for x in found if np.isfinite(x).all()]
    return np.array(places).reshape(-1, 2)


def _singular_point(patch: Patches, place: Array) -> Array:
    """Refine a zero of N(u,v) by Gauss-Newton steps; NaN if there is none."""
    half = 0.5 * np.eye(2)
    for _ in range(3):
        # N is quadratic: these differences are its derivatives.
        slopes = [_normal_at(patch, place + x) - _normal_at(patch, place - x) for x in half]
        here = _normal_at(patch, place)
        place = place - np.linalg.lstsq(np.column_stack(slopes), here, rcond=None)[0]
    size = float(patch.tangent[0]) ** 2 * (1.0 + float(np.abs(place).max())) ** 2
    vanishes = np.abs(_normal_at(patch, place)).max() <= VANISHING * size
    return place if vanishes else np.full(2, np.nan)


def _normal_at(patch: Patches, place: Array) -> Array:
    """Return N(u,v), not of unit length."""
    _, _, N = patch.apply(patch_formulas.tangents, *place)
    return np.array(N)[:, 0]


# --- one line -------------------------------------------------------------------------------------


def _directions(patch: Patches) -> list[tuple[float, float, int]]:
    """Return the coefficients s, t of all real parabolic lines, and their multiplicities.

    (s, t) are unit vectors.
    """
    angle, roots = _roots(patch)
    angles = [math.atan2(1.0, float(x.real)) + angle for x in roots if abs(x.imag) <= DOUBLE_ROOT]
    return [(math.cos(x), math.sin(x), count) for x, count in _merged(sorted(angles))]


def _roots(patch: Patches) -> tuple[float, NDArray[np.complex128]]:
    """Return an angle, and the roots x of the binary cubic of the directions (s, t).

    A direction is (x, 1), rotated by the angle, which is chosen such that no root is near infinity.
    There are no roots if the cubic vanishes.
    """
    coefficients = np.array([float(x[0]) for x in patch.apply(formulas.parabolic_directions)])
    error = (
        (CUBIC_ERROR * patch.tangent[0] + 8.0 * patch.noise[0]) * patch.second[0] * patch.tangent[0]
    )
    if np.abs(coefficients).max() <= error:
        return 0.0, np.empty(0, dtype=np.complex128)
    angles = np.linspace(0.0, math.pi, 8)[:-1]
    turns = [_turned(coefficients, angle) for angle in angles]
    best = int(np.argmax([abs(turned[0]) for turned in turns]))
    return float(angles[best]), np.roots(turns[best]).astype(np.complex128)


def _turned(coefficients: Array, angle: float) -> Array:
    """Return the binary cubic in (x, y), with s = x cos − y sin and t = x sin + y cos."""
    s = np.array([math.cos(angle), -math.sin(angle)])
    t = np.array([math.sin(angle), math.cos(angle)])
    terms = [
        k * reduce(np.convolve, [s] * (3 - power) + [t] * power)
        for power, k in enumerate(coefficients)
    ]
    return np.sum(terms, axis=0)


def _merged(angles: list[float]) -> list[tuple[float, int]]:
    """Group nearly equal angles, given in order; return the mean and the size of each group."""
    groups: list[list[float]] = []
    for angle in angles:
        if groups and angle - groups[-1][-1] <= DOUBLE_ROOT:
            groups[-1].append(angle)
        else:
            groups.append([angle])
    return [(math.fsum(group) / len(group), len(group)) for group in groups]


def _row(patch: Patches, s: complex, t: complex) -> tuple[NDArray[Any], NDArray[Any], float]:
    """Return l of the parabolic line l·(u, v, 1) = 0 with a given direction, and its unit normal.

    All points of the line have this normal. Also return the length of the normal before
    normalization.
    """
    normals = np.array(patch.apply(formulas.parabolic_normal, s, t))[..., 0]
    lengths = np.linalg.norm(normals, axis=1)
    length = float(lengths.max())
    normal = normals[int(np.argmax(lengths))] / (length or 1.0)
    row = patch.apply(formulas.parabolic_line, Vector(*normal), s, t)
    return np.array([x[0] for x in row]), normal, length


def _line(patch: Patches, s: float, t: float) -> tuple[float, Array] | None:
    """Return ρ of the line s u + t v + ρ = 0 and its normal; None for a line at infinity."""
    row, normal, length = _row(patch, s, t)
    slope = float(row[:2] @ [s, t])
    if length <= patch.normal_noise[0] or abs(slope) <= VANISHING * patch.tangent[0]:
        return None
    return float(row[2]) / slope, normal


def _segment(s: float, t: float, rho: float) -> Array | None:
    """Return the ends (2, 2) of the part of a line inside the triangle, None if there is none."""
    line = np.array([s, t, rho])
    polygon = clipped(TRIANGLE, line)
    if polygon is None:
        polygon = clipped(TRIANGLE, -line)
    assert polygon is not None
    ends = polygon[_heights(polygon, line) == 0.0]
    return ends if len(ends) == 2 else None


def _oriented(
    patch: Patches, s: float, t: float, rho: float, normal: Array, segment: Array | None
) -> Array:
    """Return the normal of a line with the orientation of N(u,v) on the line."""
    centre = TRIANGLE.mean(axis=0)
    place = centre - (s * centre[0] + t * centre[1] + rho) * np.array([s, t])
    place = place if segment is None else segment.mean(axis=0)
    return -normal if float(_normal_at(patch, place) @ normal) < 0.0 else normal


def _sign_in(patch: Patches, polygon: Array) -> int:
    """Return the sign of the cubic D(N(u,v)) inside a piece; some of its samples may be zero."""
    places = 0.5 * (polygon + polygon.mean(axis=0))
    values = cubic_bernstein(places) @ patch.cubic[0]
    return int(np.sign(values[np.abs(values).argmax()]))


def cubic_bernstein(places: Array) -> Array:
    """Return the ten cubic Bernstein polynomials (…, 10) at points u, v (…, 2).

    They are the weights of the coefficients D300, D210, ….
    """
    u, v = places[..., 0], places[..., 1]
    w = 1.0 - u - v
    indices = [(i, j, 3 - i - j) for i in range(3, -1, -1) for j in range(3 - i, -1, -1)]
    return np.stack(
        [6 // math.prod(map(math.factorial, x)) * u ** x[0] * v ** x[1] * w ** x[2]
         for x in indices],
        axis=-1,
    )  # fmt: skip
