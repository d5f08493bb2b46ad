"""Membership in the Gaussian image of one patch: in floating point, and exactly where undecided."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated import gaussian_image as lines
from ...generated import patch as formulas
from ...generated.vectors import Patch, Vector
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scale_to_one
from ...runtime.base.tolerances import ACCURATE, FORM_ERROR, NEAR_SINGULAR_POINT
from ...runtime.search.long_integers import integers, integers_by_row, ratio, sign
from .kernels import support as kernels

Array = NDArray[np.float64]
Place = tuple[Fraction, Fraction]
# Vectors whose largest component is at least ½ and below 1 are shorter than √3.
LONGEST_SQUARED = 3.0


@dataclass(frozen=True, eq=False)
class Members:
    """Decisions whether each of k vectors is the normal of a regular, non-parabolic point.

    `inside` (k,) are the decisions, and `uv` (k, 2) the parameters of the points. `signs` (k,) is
    the sign of K where it was decided exactly, else 0. Where `vanishing` (k,) is true, D, U, V, W
    are all zero: the vector may be the normal along a parabolic line.
    """

    inside: NDArray[np.bool_]
    uv: Array
    signs: NDArray[np.int8]
    vanishing: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class PatchNormals:
    """The set of the oriented normals of one quadratic patch; membership is decided exactly.

    `control_points` are (6, 3). The boundary of the patch belongs to it.
    """

    control_points: Array

    def members(self, normals: Array) -> Members:
        """Decide which of the vectors (k, 3) are normals of non-parabolic points."""
        count = len(normals)
        kinds, uv = np.empty(count, dtype=np.int8), np.zeros((count, 2))
        exponents = np.frexp(np.abs(normals).max(axis=1, keepdims=True))[1]
        scaled = np.ldexp(normals, -exponents)
        kernels.classify(
            self.vectors, self._bound, ACCURATE * self._bound,
            self._shortest, scaled, kinds, uv,
        )  # fmt: skip
        result = Members(
            kinds == kernels.INSIDE, uv, np.zeros(count, dtype=np.int8), np.zeros(count, dtype=bool)
        )
        open_ = np.flatnonzero(kinds == kernels.DOUBTFUL)
        if len(open_):
            self._decide(result, open_, normals[open_])
        return result

    def contain(self, normals: Array) -> NDArray[np.bool_]:
        """Return a mask of the vectors (k, 3) that are normals of points, even parabolic ones."""
        members = self.members(normals)
        which = np.flatnonzero(members.vanishing)
        n, _ = integers_by_row(normals[which])
        for k, normal in zip(which, n.T.tolist(), strict=True):
            members.inside[k] = _on_line(self.exact_vectors, Vector(*normal))
        return members.inside

    @cached_property
    def scale(self) -> float:
        """A power of two that scales the differences of control points to about 1."""
        largest = float(np.abs(self.control_points - self.control_points[2]).max())
        return scale_to_one(largest)

    @cached_property
    def vectors(self) -> Patch:
        """The vectors a, b, c, d, e, p of eq. (8) of the paper, times the scale.

        p is relative to the control point b002.
        """
        net = self.scale * (self.control_points - self.control_points[2])
        found = python_function(formulas.power_form)(*map(vector, net))
        return Patch(*(Vector(*map(float, x)) for x in found))

    @cached_property
    def exact_vectors(self) -> Patch:
        """The vectors of eq. (8) of the paper as integers, up to a common power of two."""
        net, _ = integers(self.control_points)
        return python_function(formulas.power_form)(*map(vector, net))

    @cached_property
    def _sizes(self) -> tuple[float, float]:
        """The largest components of a, b, c and of d, e."""
        sizes = np.abs(self.vectors[:5])
        return float(sizes[:3].max()), float(sizes[3:].max())

    @cached_property
    def _bound(self) -> float:
        """A bound of the rounding errors of the forms U, V, W, like that in `put_piece`.

        It is positive even if a, b, c are 0. These vectors are combinations of differences of
        control points; the largest difference is about 1, so that a linear form, such as n·a, has
        an error of up to about FORM_ERROR, however short its vector is.
        """
        error = FORM_ERROR * (sum(self._sizes) + FORM_ERROR)
        return 32.0 * LONGEST_SQUARED * error

    @cached_property
    def _shortest(self) -> float:
        """The least |N_x| + |N_y| + |N_z| at which the direction of N is certain."""
        return NEAR_SINGULAR_POINT * (2.0 * self._sizes[0] + self._sizes[1]) ** 2

    def _decide(self, members: Members, rows: NDArray[np.intp], normals: Array) -> None:
        """Decide normals exactly, with integers, and write the decisions to `rows` of `members`."""
        n, _ = integers_by_row(normals)
        patch, normal = self.exact_vectors, Vector(*n)
        forms = np.array(python_function(formulas.forms)(patch, normal), dtype=object)
        D, *bounds = (sign(x) for x in forms)
        orientation = python_function(formulas.orientation)(patch, normal)
        c3 = sign(np.asarray(orientation, dtype=object))
        signs = np.stack(bounds)
        one_sign = (signs.min(axis=0) >= 0) | (signs.max(axis=0) <= 0)
        inside = one_sign & (D != 0) & (c3 > 0)
        for axis in (0, 1):
            quotients = ratio(forms[axis + 1, inside], forms[0, inside])
            members.uv[rows[inside], axis] = quotients
        members.inside[rows], members.signs[rows] = inside, D
        members.vanishing[rows] = (D == 0) & (signs == 0).all(axis=0)


def _on_line(patch: Patch, n: Vector) -> bool:
    """Return whether n is the normal along a parabolic line, or of the whole patch.

    The forms U, V and D must vanish at n.
    """
    line = python_function(lines.parabolic_line)
    rows = [line(patch, n, s, t) for s, t in ((1, 0), (0, 1))]
    row = next((row for row in rows if row[0] or row[1]), None)
    corners = [(Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)), (Fraction(0), Fraction(0))]
    if row is None:
        flat = not any(x[2] for x in rows)
        edges = zip(corners, corners[1:] + corners[:1], strict=True)
        return flat and any(_has_direction(patch, n, *edge) for edge in edges)
    ends = _ends(row, corners)
    return bool(ends) and _has_direction(patch, n, ends[0], ends[-1])


def _ends(row: tuple[int, int, int], corners: list[Place]) -> list[Place]:
    """Return the intersections of a line with the boundary of the triangle, in order."""
    heights = [row[0] * u + row[1] * v + row[2] for u, v in corners]
    found = {corner for corner, height in zip(corners, heights, strict=True) if height == 0}
    for k in range(3):
        (u0, v0), (u1, v1) = corners[k], corners[k - 1]
        h0, h1 = heights[k], heights[k - 1]
        if h0 * h1 < 0:
            share = h0 / (h0 - h1)
            found.add((u0 + (u1 - u0) * share, v0 + (v1 - v0) * share))
    return sorted(found)


def _has_direction(patch: Patch, n: Vector, first: Place, last: Place) -> bool:
    """Return whether N·n is positive somewhere on the segment between two parameter pairs."""

    def towards(u: Fraction, v: Fraction) -> Fraction:
        _, _, field = python_function(formulas.tangents)(patch, u, v)
        return sum((x * y for x, y in zip(field, n, strict=True)), start=Fraction(0))

    start, end = towards(*first), towards(*last)
    middle = towards((first[0] + last[0]) / 2, (first[1] + last[1]) / 2)
    inner = 2 * middle - (start + end) / 2  # the middle Bézier coefficient of this quadratic
    return start > 0 or end > 0 or (inner > 0 and inner * inner > start * end)
