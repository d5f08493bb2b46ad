"""Sources of support functions: a surface, a spline, one patch, an expression."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import patch as formulas
from ...runtime.base.bridge import bezier_triangle
from ...runtime.base.errors import InputError
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.domain.trim import samples_inside
from ...runtime.map import GaussMap
from ...runtime.samples.fields import Component
from ...runtime.samples.report import SamplingReport
from ...runtime.search.hits import fill
from ...runtime.search.search import find
from ...runtime.spline.nets import AnySpline, NetSpline
from ...runtime.surface.surface import Surface
from ..gauss_map.kernels import support as kernels
from ..gauss_map.membership import PatchNormals
from ..gauss_map.patches import checked_control_points
from .branches import Sheets

if TYPE_CHECKING:
    import sympy

# Quadratic and cubic forms in three variables that vanish at these points vanish everywhere.
FOR_QUADRATICS = [(2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
FOR_CUBICS = [(i, j, 3 - i - j) for i in range(4) for j in range(4 - i)]


class Source(Protocol):
    """A support function that can be evaluated, and may have a symbolic expression."""

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return all branches at unit normals (S, 3), sorted by normal."""
        ...

    def expression(self) -> sympy.Expr | None:
        """Return h in n_x, n_y, n_z, on the unit sphere; None if there is no single expression."""
        ...

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the condition on n_x, n_y, n_z for a branch; None without a single condition."""
        ...

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return pairs of a factor and a spline: branches lie on the spline times the factor."""
        ...


# A point counts as a pole if |x_u × x_v| is below this part of the larger of |x_u|² and |x_v|².
# Three rays leave the pole, at these fractions of a turn from the given point.
COLLAPSED, RAYS = 1e-7, (0.0, 1 / 3, 2 / 3)


class SurfaceSource:
    """The support function of a surface itself, not of its spline; see `GaussMap.points`.

    After a call of `sheets`, `report` is the report on its result, and `on_surface` (k,) says which
    of its points are on the surface.
    """

    def __init__(self, known: GaussMap, surface: Surface) -> None:
        self.map, self.surface = known, surface
        self.report: SamplingReport
        self.on_surface: NDArray[np.bool_]

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return the branches at all points with these normals, sorted by normal."""
        found = self.map._with_fit(self.map.points(normals))  # the warning uses its report
        assert found.on_surface is not None
        self.report, self.on_surface = found.report, found.on_surface
        order = np.argsort(found.normal_index, kind="stable")
        found, self.on_surface = found[order], found.on_surface[order]
        hessian = _hessians_on_surface(self.surface, normals[found.normal_index], found.uv)
        hessian[found.component == Component.TIP] = 0.0  # where the support function is linear
        as_one_patch = np.zeros_like(found.normal_index)
        return Sheets(
            found.normal_index, found.points, hessian, found.gaussian_curvature,
            found.mean_curvature, as_one_patch, found.uv,
        )  # fmt: skip

    def expression(self) -> None:
        """Return None: the branches have no common expression."""

    def domain(self) -> None:
        """Return None: the branches have no common domain."""

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return an empty list."""
        return []

    def __str__(self) -> str:
        return self.surface.name


@dataclass(frozen=True, eq=False)
class SplineSource:
    """The support functions of all patches of a spline, with each point exactly once."""

    spline: AnySpline

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return all branches inside the trim, sorted by normal, then by patch."""
        hits = find(self.spline, normals)
        fields = fill(self.spline, normals, hits)
        known = np.full((len(hits), 2), np.nan)
        known[hits.exact] = hits.local[:, 3:5]
        patches, rows, trim = hits.patch_index, hits.normal_index, None
        if isinstance(self.spline, NetSpline):
            hessian = _hessians_in_nets(self.spline, patches, normals[rows], fields["uv"])
        else:
            trim, hessian = self.spline.trim, np.empty((len(hits), 3, 3))
            kernels.hessians_of_patches(
                self.spline.coefficients, self.spline.scale, patches, normals[rows], known, hessian
            )
        found = Sheets(
            rows, fields["points"], hessian, fields["gaussian_curvature"],
            fields["mean_curvature"], patches, fields["uv"],
        )  # fmt: skip
        return Sheets(**samples_inside(trim, vars(found), tuple(vars(found))))

    def expression(self) -> None:
        """Return None: a spline has one expression for each patch."""

    def domain(self) -> None:
        """Return None: a spline has one domain for each patch."""

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return the spline."""
        return [(1.0, self.spline)]

    def __str__(self) -> str:
        return f"{self.spline.name}, {self.spline.patches:,} patches"


@dataclass(frozen=True, eq=False)
class PatchSource:
    """The support function of one quadratic Bézier triangle (10) with `control_points` (6, 3).

    A normal has a branch if the closed triangle has a regular point with that oriented normal.
    Signs that rounding leaves open are decided in exact arithmetic.
    """

    control_points: NDArray[np.float64]

    @classmethod
    def checked(cls, control_points: ArrayLike) -> PatchSource:
        """Return a source; InputError unless the patch has a support function."""
        source = cls(checked_control_points(control_points))
        vectors = source._normals.exact_vectors
        D, *_ = python_function(formulas.forms)(vectors, vector(np.array(FOR_QUADRATICS, object)))
        if not D.any():
            raise InputError("the patch is flat or developable: it has no support function.")
        c3 = python_function(formulas.orientation)(vectors, vector(np.array(FOR_CUBICS, object)))
        if not c3.any():
            raise InputError("the patch has no regular point, so it has no normals.")
        return source

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return the branch of each normal that has one."""
        members = self._normals.members(normals)
        rows = np.flatnonzero(members.inside)
        count, uv, signs = len(rows), members.uv[rows], members.signs[rows]
        points, hessian = np.empty((count, 3)), np.empty((count, 3, 3))
        gaussian, mean = np.empty(count), np.empty(count)
        u, v = np.ascontiguousarray(uv.T)
        vectors, scale = self._normals.vectors, self._normals.scale
        kernels.branches_of_patch(vectors, normals[rows], u, v, points, hessian, gaussian, mean)
        points, hessian = self.control_points[2] + points / scale, hessian / scale
        gaussian, mean = gaussian * scale * scale, mean * scale
        gaussian = np.where(signs != 0, np.copysign(gaussian, signs), gaussian)
        return Sheets(rows, points, hessian, gaussian, mean, np.zeros(count, dtype=np.int64), uv)

    def expression(self) -> sympy.Expr:
        """Return the cubic over the quadratic form, with the exact values of the control points."""
        return self._symbolic.support_function

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the closed Gaussian image as a condition, without singular points.

        There the forms U, V, W of the patch have one sign.
        """
        import sympy as sp

        D, U, V, W = self._symbolic.forms.values()
        at_least, unequal = cast(Any, sp.Ge), cast(Any, sp.Ne)  # typed as numbers, too
        inside = [sp.And(*(at_least(s * x, 0) for x in (U, V, W))) for s in (1, -1)]
        return sp.And(sp.Or(*inside), unequal(D, 0), sp.Gt(self._symbolic.orientation, 0))

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return an empty list: the patch is the surface."""
        return []

    def __str__(self) -> str:
        return "quadratic patch"

    @cached_property
    def _symbolic(self) -> Any:  # noqa: ANN401 - SymPy is loaded here only
        return bezier_triangle(self.control_points.tolist())

    @cached_property
    def _normals(self) -> PatchNormals:
        return PatchNormals(self.control_points)


def _hessians_in_nets(
    spline: NetSpline, patches: NDArray[np.int64], normals: NDArray[np.float64],
    uv: NDArray[np.float64],
) -> NDArray[np.float64]:  # fmt: skip
    """Return the Hessians (k, 3, 3) of the support function at unit normals (k, 3)."""
    patch, n = spline._patch(patches), vector(normals)
    D, *_ = python_function(formulas.forms)(patch, n)
    A, B, C, _, _ = python_function(formulas.linear_forms)(patch, n)
    p_u, p_v, _ = python_function(formulas.tangents)(patch, *uv.T)
    return _matrices(A, B, C, D, p_u, p_v) / spline.scale


def _hessians_on_surface(
    surface: Surface, normals: NDArray[np.float64], uv: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the Hessians (k, 3, 3) at points of a surface with unit normals (k, 3)."""
    low, high = np.array(surface.domain).T
    size = high - low
    _, x_u, x_v, *second = np.moveaxis(surface.jets(*uv.T), 1, 0)
    x_u, x_v = size[0] * x_u, size[1] * x_v
    lengths = [np.linalg.norm(x, axis=1) for x in (x_u, x_v)]
    scales = (size[0] ** 2, size[0] * size[1], size[1] ** 2)
    forms = [f * np.einsum("ij,ij->i", normals, x) for f, x in zip(scales, second, strict=True)]
    with np.errstate(all="ignore"):  # radii are infinite at parabolic points
        A, B, C = forms
        found = _matrices(A, B, C, A * C - B * B, vector(x_u), vector(x_v))
        large = np.linalg.norm(np.cross(x_u, x_v), axis=1)
    for k in np.flatnonzero(~(large > COLLAPSED * np.maximum(*lengths) ** 2)):
        axis = int(lengths[1][k] > lengths[0][k])  # along the rays
        found[k] = _hessian_at_pole(surface, normals[k], uv[k], axis)
    return found


def _hessian_at_pole(
    surface: Surface, normal: NDArray[np.float64], uv: NDArray[np.float64], axis: int
) -> NDArray[np.float64]:
    """Return the Hessian (3, 3) at a collapsed side of the domain, where rays along `axis` begin.

    The second fundamental form is quadratic on the tangent plane: three rays determine it.
    """
    (low, high), places = surface.domain[1 - axis], np.tile(uv, (len(RAYS), 1))
    turned = (uv[1 - axis] - low) / (high - low) + np.array(RAYS)
    places[:, 1 - axis] = low + (high - low) * np.mod(turned, 1.0)
    jets = surface.jets(*np.ascontiguousarray(places.T))
    tangents, bends = jets[:, 1 + axis], jets[:, 3 + 2 * axis] @ normal
    frame = np.linalg.svd(normal[None])[2][1:]
    x, y = frame @ tangents.T
    with np.errstate(all="ignore"):
        try:
            A, B, C = np.linalg.solve(np.stack([x * x, 2 * x * y, y * y], axis=1), bends)
        except np.linalg.LinAlgError:
            return np.full((3, 3), np.nan)
        one, two = (vector(row[None]) for row in frame)
        D = np.array([A * C - B * B])
        return _matrices(A, B, C, D, one, two)[0]


def _matrices(A: Any, B: Any, C: Any, D: Any, p_u: Any, p_v: Any) -> NDArray[np.float64]:  # noqa: ANN401
    """Return the Hessians (k, 3, 3) from second fundamental forms A, B, C and tangents.

    D are the determinants A C − B².
    """
    H = python_function(formulas.hessian)(A, B, C, D, p_u, p_v)
    rows = [[H.H_xx, H.H_xy, H.H_xz], [H.H_xy, H.H_yy, H.H_yz], [H.H_xz, H.H_yz, H.H_zz]]
    return np.moveaxis(np.array(rows), 2, 0)
