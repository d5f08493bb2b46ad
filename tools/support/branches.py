"""The values of a support function at given normals: one row for each branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...generated import support as formulas
from ...generated.vectors import Hessian
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scales_to_one


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Branches:
    """The k branches of a support function at S normals, sorted by normal, then by patch.

    Lengths are in the unit L of the surface. Where one of the two radii is 0 the surface is
    singular: the Gaussian curvature is infinite, and the mean curvature infinite or NaN. Where a
    radius is infinite, at a parabolic point, Hessian and radii are infinite or NaN; the Gaussian
    curvature is then 0, or NaN after a sum.

    Attributes
    ----------
    normal_index : (k,) int64 array
        Rows of the prescribed normals.
    normals : (k, 3) float64 array
        The unit normals of the branches.
    support : (k,) float64 array
        The support function h(n) = n·x (4), in L.
    points : (k, 3) float64 array
        The points x(n) of the envelope (5), in L.
    hessian : (k, 3, 3) float64 array
        Second derivatives of the support function (homogeneous of degree 1), in L: hessian @ n = 0,
        and the eigenvalues in the tangent plane are the radii.
    principal_radii : (k, 2) float64 array
        Signed principal radii of curvature in L, the larger one first; positive on a sphere with
        outward normals.
    gaussian_curvature : (k,) float64 array
        In 1/L². A point is hyperbolic where its sign bit is set.
    mean_curvature : (k,) float64 array
        In 1/L, positive on a sphere with outward normals.
    patch_index : (k,) int64 array
        Patches of the spline, 0 for a surface itself or a single patch; −1 for no or several
        patches.
    uv : (k, 2) float64 array
        Parameters of the points; NaN where `patch_index` is −1.

    Examples
    --------
    >>> import gaussmap as gm
    >>> h = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")
    >>> branches = h.branches([[2, 0, 0]])
    >>> branches.normals, branches.support, branches.points
    (array([[1., 0., 0.]]), array([2.]), array([[2., 0., 0.]]))
    >>> branches.principal_radii, branches.gaussian_curvature, branches.mean_curvature
    (array([[0.5, 0.5]]), array([4.]), array([2.]))
    >>> branches.hessian.shape, branches.normal_index, branches.patch_index, branches.uv
    ((1, 3, 3), array([0]), array([-1]), array([[nan, nan]]))
    >>> branches.elliptic, branches.hyperbolic
    (array([ True]), array([False]))

    """

    normal_index: NDArray[np.int64]
    normals: NDArray[np.float64]
    support: NDArray[np.float64]
    points: NDArray[np.float64]
    hessian: NDArray[np.float64]
    principal_radii: NDArray[np.float64]
    gaussian_curvature: NDArray[np.float64]
    mean_curvature: NDArray[np.float64]
    patch_index: NDArray[np.int64]
    uv: NDArray[np.float64]

    @property
    def elliptic(self) -> NDArray[np.bool_]:
        """(k,) bool array: where the Gaussian curvature is positive (its sign bit is clear)."""
        return ~self.hyperbolic

    @property
    def hyperbolic(self) -> NDArray[np.bool_]:
        """(k,) bool array: where the Gaussian curvature is negative (its sign bit is set)."""
        return np.signbit(self.gaussian_curvature)

    def __len__(self) -> int:
        """Return the total number of branches of all normals."""
        return len(self.support)

    def __repr__(self) -> str:
        hyperbolic = int(np.count_nonzero(self.hyperbolic))
        return f"Branches({len(self) - hyperbolic:,} elliptic, {hyperbolic:,} hyperbolic)"


@dataclass(frozen=True, eq=False)
class Sheets:
    """The values that sources of support functions return: `Branches` without derived fields."""

    normal_index: NDArray[np.int64]
    points: NDArray[np.float64]
    hessian: NDArray[np.float64]
    gaussian: NDArray[np.float64]
    mean: NDArray[np.float64]
    patch_index: NDArray[np.int64]
    uv: NDArray[np.float64]

    def branches(self, normals: NDArray[np.float64]) -> Branches:
        """Return the branches at unit normals (S, 3)."""
        mine = normals[self.normal_index]
        support = python_function(formulas.tangent_plane)(vector(mine), vector(self.points))
        radii, _, _ = curvatures(mine, self.hessian)
        return Branches(
            self.normal_index, mine, support, self.points, self.hessian, radii,
            self.gaussian, self.mean, self.patch_index, self.uv,
        )  # fmt: skip


def curvatures(
    normals: NDArray[np.float64], hessian: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return principal radii (k, 2), Gaussian and mean curvature at unit normals (k, 3)."""
    scale = scales_to_one(np.abs(hessian).max(axis=(1, 2)))  # so that determinants do not overflow
    scaled = hessian * scale[:, None, None]
    entries = Hessian(*scaled[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].T)
    with np.errstate(all="ignore"):  # infinite curvatures and radii are valid
        formula = python_function(formulas.curvature_from_hessian)
        middle, _, square, gaussian, mean = formula(vector(normals), entries)
        radii = np.stack([middle + np.sqrt(square), middle - np.sqrt(square)], axis=1)
        return radii / scale[:, None], gaussian * scale * scale, mean * scale
