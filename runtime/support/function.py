"""The support function as an object: given in three ways, evaluated, combined (paper, Sect. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import bridge
from ..checks import finite_array, finite_number
from ..directions.unit import as_normals
from ..errors import InputError
from ..fitting import spline_of
from ..spline import Spline
from ..surface import Surface
from ..surfaces import named
from .branches import Branches, Sheets
from .operations import Offset, Reversed, Rotated, Scaled, Sum, Translated
from .sources import PatchSource, Source, SplineSource

if TYPE_CHECKING:
    import sympy

__all__ = ["SupportFunction"]

# A rotation may miss R Rᵀ = 1 by the rounding of its entries and of a few products of rotations.
ROTATION_ERROR = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class SupportFunction:
    """A support function h(n): the distance from the origin of the tangent plane with normal n.

    Make one with `of_spline`, `of_patch` or `from_sympy`. Several points of a surface may have one
    normal, each on a *branch* of h; `branches` returns all of them. The envelope operator (7) gives
    the points, so that operations on surfaces are simple ones on support functions: `+`, `offset`,
    `translated`, `rotated`, `scaled`, `reversed`. They return new objects and compute nothing
    before these are evaluated.
    """

    _source: Source

    @classmethod
    def of_spline(
        cls, surface: Spline | Surface | str, cells: Sequence[int] | None = None
    ) -> SupportFunction:
        """Return the support function of a spline, with the branches of all its patches.

        A `Surface` is approximated by a spline first; `cells` and errors are those of `fit`. Every
        point with a given normal is one branch, exactly once. Flat and developable patches have no
        support function, and so no branch. Raises InputError for `cells` with a spline.
        """
        surface = named(surface)
        if not isinstance(surface, Spline | Surface):
            raise InputError(f"of_spline takes a Spline or Surface, not {_kind(surface)}.")
        return cls(SplineSource(spline_of(surface, cells)))

    @classmethod
    def of_patch(cls, control_points: ArrayLike) -> SupportFunction:
        """Return the support function of a quadratic Bézier triangle (10).

        `control_points` (6, 3) are b200, b020, b002, b110, b101, b011. The function is a cubic over
        a quadratic form on the Gaussian image of the closed triangle, and single-valued there: a
        normal has one branch or none. Which, is decided exactly, on the boundary too. Normals of
        parabolic and singular points have no branch.

        Raises InputError for another shape, NaN, infinity, numbers too large to compute with, and
        for a patch that is flat or developable or has no regular point.
        """
        return cls(PatchSource.checked(control_points))

    @classmethod
    def from_sympy(
        cls,
        h: sympy.Expr | str | float,
        normal: Sequence[sympy.Symbol | str] = ("n_x", "n_y", "n_z"),
        domain: object = None,
    ) -> SupportFunction:
        """Return the support function given by a SymPy expression (or text) on the unit sphere.

        `h` is evaluated at unit normals only, so that it may be any function of the components of
        the normal; if it is homogeneous of degree 1, its gradient is the envelope. Otherwise that
        is (5), with the intrinsic gradient (6). Derivatives are taken by SymPy and compiled.
        `domain` is a condition, such as "n_z > 0" or "(n_x > 0) & (n_y > 0)"; without it the domain
        is the whole sphere. Normals where h or its gradient is not real and finite have no branch.
        A kink, such as that of |n_x|, is a planar region of the surface, which has no samples.

        Texts are read as in `Surface.from_sympy`. Raises InputError for what is no real expression
        in the three components, uses functions that cannot be compiled, or is too large.
        """
        from .expression import ExpressionSource

        return cls(ExpressionSource.checked(h, normal, domain))

    # --- evaluation -------------------------------------------------------------------------------

    def branches(self, normals: ArrayLike) -> Branches:
        """Return all branches at normals (S, 3), directions of any length.

        Rows are ordered by normal, then by patch. Raises InputError for normals that have another
        shape, are empty, zero, NaN or infinite.
        """
        directions = as_normals(normals)
        return self._sheets(directions).branches(directions)

    def sheets(self, normals: ArrayLike) -> NDArray[np.int64]:
        """Return how many branches each of the normals (S, 3) has, (S,) int64; see `branches`."""
        directions = as_normals(normals)
        rows = self._sheets(directions).normal_index
        return np.bincount(rows, minlength=len(directions)).astype(np.int64)

    def contains(self, normals: ArrayLike) -> NDArray[np.bool_]:
        """Return which normals (S, 3) lie in the domain of h: (S,) bool; see `branches`."""
        return self.sheets(normals) > 0

    def envelope(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return the points x(n) of the envelope (5), (S, 3), NaN outside the domain.

        Raises InputError if a normal has several branches; `branches` returns all of them.
        """
        branches, count = self._single_valued(normals)
        points = np.full((count, 3), np.nan)
        points[branches.normal_index] = branches.points
        return points

    def __call__(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return h(n/|n|), (S,), NaN outside the domain; errors as in `envelope`."""
        branches, count = self._single_valued(normals)
        values = np.full(count, np.nan)
        values[branches.normal_index] = branches.support
        return values

    def _sheets(self, directions: NDArray[np.float64]) -> Sheets:
        with np.errstate(all="ignore"):  # infinite curvatures and radii are valid
            return self._source.sheets(directions)

    def _single_valued(self, normals: ArrayLike) -> tuple[Branches, int]:
        directions = as_normals(normals)
        branches = self._sheets(directions).branches(directions)
        sheets = np.bincount(branches.normal_index, minlength=len(directions))
        if sheets.max() > 1:
            worst = int(np.argmax(sheets > 1))
            raise InputError(
                f"normals[{worst}] has {sheets[worst]} branches; branches(normals) returns them."
            )
        return branches, len(directions)

    # --- operations -------------------------------------------------------------------------------

    def __add__(self, other: SupportFunction) -> SupportFunction:
        """Return the convolution of two surfaces: all sums of two points with the same normal.

        A normal has every pair of branches. `patch_index` and `uv` are those of the summand that
        has patches, −1 and NaN if both have.
        """
        if not isinstance(other, SupportFunction):
            return NotImplemented
        return SupportFunction(Sum(self._source, other._source))

    def __radd__(self, other: object) -> SupportFunction:
        """Return 0 + h = h, so that `sum` can add several."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def offset(self, distance: float) -> SupportFunction:
        """Return h + d |n|: the offset surface of the points x + d n, inwards for d < 0.

        Raises InputError unless the distance is a finite number.
        """
        return SupportFunction(Offset(self._source, finite_number(distance, "distance")))

    def translated(self, shift: ArrayLike) -> SupportFunction:
        """Return h + n·t: the surface of the points x + t.

        Raises InputError unless t is three finite numbers.
        """
        return SupportFunction(Translated(self._source, finite_array(shift, (3,), "shift")))

    def rotated(self, rotation: ArrayLike) -> SupportFunction:
        """Return h(Rᵀn): the surface of the points R x, for a rotation matrix R (3, 3).

        Raises InputError unless R Rᵀ = 1 (up to 1e-12) and det R = 1.
        """
        R = finite_array(rotation, (3, 3), "rotation")
        with np.errstate(over="ignore", invalid="ignore"):
            orthogonal = np.abs(R @ R.T - np.eye(3)).max() <= ROTATION_ERROR
        if not orthogonal:
            raise InputError("rotation must be an orthogonal matrix: R Rᵀ is not the identity.")
        if np.linalg.det(R) < 0.0:
            raise InputError("rotation must have det R = 1; this one is a reflection.")
        return SupportFunction(Rotated(self._source, R))

    def scaled(self, factor: float) -> SupportFunction:
        """Return s h: the surface of the points s x.

        For s < 0 the points are also reflected in the origin, and keep their normals (as p_u × p_v
        does): the radii change their sign. Raises InputError unless s is finite and not 0.
        """
        s = finite_number(factor, "factor")
        if s == 0.0:
            raise InputError("factor must not be 0: the surface would shrink to a point.")
        return SupportFunction(Scaled(self._source, s))

    def reversed(self) -> SupportFunction:
        """Return −h(−n): the same surface with the opposite orientation."""
        return SupportFunction(Reversed(self._source))

    # --- how it is written ------------------------------------------------------------------------

    @property
    def expression(self) -> sympy.Expr | None:
        """The SymPy expression h in n_x, n_y, n_z, valid on the unit sphere; None for splines."""
        return self._source.expression()

    @property
    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """The domain as a SymPy condition on n_x, n_y, n_z; None for splines (see `contains`).

        Where an expression is not finite it has no branch either, which the condition does not say.
        """
        return self._source.domain()

    def _repr_latex_(self) -> str | None:
        """Show the expression in a notebook, if there is one."""
        expression = self.expression
        if expression is None:
            return None
        return rf"$\displaystyle h(\mathbf{{n}}) = {bridge.latex_of(expression)}$"

    def __repr__(self) -> str:
        return f"SupportFunction({self._source})"


def _kind(value: object) -> str:
    return type(value).__name__
