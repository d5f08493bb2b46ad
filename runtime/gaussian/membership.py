"""Which normals a single patch has: in floating point where that is sure, on integers elsewhere."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...generated import gaussian_image as lines
from ...generated import patch as formulas
from ..integers import integers, integers_by_row
from ..plain import plain
from .patches import Patches

__all__ = ["has_normals"]

Array = NDArray[np.float64]
Place = tuple[Fraction, Fraction]
# The forms are sums of at most six products of two scalar products, for vectors and normals of any
# direction: their rounding error is below 2⁻⁴⁴ times the lengths of the vectors.
FORM_ERROR = math.ldexp(1.0, -44)
# What exceeds the error by this factor gives the parameters to a few digits.
ACCURATE = 65536.0
# Near a singular point, where N is this short beside the square of the tangents, the few digits of
# the parameters do not give its direction.
SINGULAR = 2.0**-12


def has_normals(control_points: Array, normals: Array) -> NDArray[np.bool_]:
    """Say which of the vectors (k, 3) are oriented normals of a patch (6, 3), border included."""
    exponents = np.frexp(np.abs(normals).max(axis=1, keepdims=True))[1]
    scaled = np.ldexp(normals, -exponents)
    inside, sure = _rounded(Patches.of_control_points(control_points[None]), scaled)
    open_ = np.flatnonzero(~sure)
    if len(open_):
        inside[open_] = _exact(control_points, scaled[open_])
    return inside


def _rounded(patch: Patches, n: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which normals the patch has, and for which of them rounding leaves no doubt."""
    D, U, V, W = (np.broadcast_to(x, len(n)) for x in patch.apply(formulas.forms, *n.T))
    size = float(patch.second[0] * patch.tangent[0])
    error = FORM_ERROR * size * 3.0
    low, high = np.minimum.reduce([U, V, W]), np.maximum.reduce([U, V, W])
    outside = (low < -error) & (high > error)
    sure = ((low > error) | (high < -error)) & (np.abs(D) > ACCURATE * error)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = np.where(sure, U / D, 0.0), np.where(sure, V / D, 0.0)
    N = np.stack([x + 0.0 * u for x in patch.apply(formulas.tangents, u, v)[6:]], axis=1)
    towards = np.einsum("kx,kx->k", N, n)
    lengths = np.linalg.norm(N, axis=1) * np.linalg.norm(n, axis=1)
    regular = np.linalg.norm(N, axis=1) > SINGULAR * float(patch.tangent[0]) ** 2
    clear = (np.abs(towards) > 0.25 * lengths) & regular
    return sure & clear & (towards > 0.0), outside | (sure & clear)


def _exact(control_points: Array, normals: Array) -> NDArray[np.bool_]:
    """Decide on integers: D ≠ 0, or the whole of a parabolic or ruling line has the normal."""
    points, _ = integers(control_points)
    vectors = np.array(plain(formulas.power_form)(*points.ravel())[:15], dtype=object)
    n, _ = integers_by_row(normals)
    columns = np.broadcast_to(vectors[:, None], (15, n.shape[1]))
    forms = np.array(plain(formulas.forms)(*columns, *n), dtype=object)
    positive = np.asarray(forms >= 0, dtype=bool)
    negative = np.asarray(forms <= 0, dtype=bool)
    inside = (positive[1:].all(axis=0) | negative[1:].all(axis=0)) & np.asarray(
        forms[0] != 0, dtype=bool
    )
    orientation = np.asarray(plain(formulas.orientation)(*columns, *n) > 0, dtype=bool)
    inside &= orientation
    vanishing = np.asarray(forms[:3] == 0, dtype=bool).all(axis=0)
    for k in np.flatnonzero(vanishing):
        inside[k] = _on_line(vectors.tolist(), n[:, k].tolist())
    return inside


def _on_line(vectors: list[int], n: list[int]) -> bool:
    """Say whether a normal with U = V = D = 0 is that of a point: of a line of them, or of all."""
    rows = [plain(lines.parabolic_line)(*vectors, *n, s, t) for s, t in ((1, 0), (0, 1))]
    row = next((row for row in rows if row[0] or row[1]), None)
    corners = [(Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)), (Fraction(0), Fraction(0))]
    if row is None:
        flat = not any(x[2] for x in rows)
        edges = zip(corners, corners[1:] + corners[:1], strict=True)
        return flat and any(_has_direction(vectors, n, *edge) for edge in edges)
    ends = _ends(row, corners)
    return bool(ends) and _has_direction(vectors, n, ends[0], ends[-1])


def _ends(row: tuple[int, int, int], corners: list[Place]) -> list[Place]:
    """Return the points where a line meets the border of the triangle, from end to end."""
    heights = [row[0] * u + row[1] * v + row[2] for u, v in corners]
    found = {corner for corner, height in zip(corners, heights, strict=True) if height == 0}
    for k in range(3):
        (u0, v0), (u1, v1) = corners[k], corners[k - 1]
        h0, h1 = heights[k], heights[k - 1]
        if h0 * h1 < 0:
            share = h0 / (h0 - h1)
            found.add((u0 + (u1 - u0) * share, v0 + (v1 - v0) * share))
    return sorted(found)


def _has_direction(
    vectors: list[int],
    n: list[int],
    first: Place,
    last: Place,
) -> bool:
    """Say whether N·n is positive somewhere between two places of the parameter plane."""

    def towards(u: Fraction, v: Fraction) -> Fraction:
        field = plain(formulas.tangents)(*vectors, u, v)[6:]
        return sum((x * y for x, y in zip(field, n, strict=True)), start=Fraction(0))

    start, end = towards(*first), towards(*last)
    middle = towards((first[0] + last[0]) / 2, (first[1] + last[1]) / 2)
    inner = 2 * middle - (start + end) / 2  # the middle Bézier coefficient of this quadratic
    return start > 0 or end > 0 or (inner > 0 and inner * inner > start * end)
