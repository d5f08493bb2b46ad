"""The support function of a planar curve as an object: branches, convolution, offset, motions."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import finite_array, finite_number
from ...runtime.base.errors import InputError
from ...runtime.directions.unit import as_normals
from ..support.operations import pairs
from .curve import Curve
from .curve_sampling import filled, find
from .curve_spline import CurveSpline
from .fitting import fit

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class CurveBranches:
    """The k branches of the support function of a planar curve at S normals, sorted by normal.

    Attributes
    ----------
    normal_index : (k,) int64 array
        Rows of the prescribed normals.
    normals : (k, 2) float64 array
        The unit normals of the branches.
    support : (k,) float64 array
        The support function h(n) = n·x, in the unit L of the curve.
    points : (k, 2) float64 array
        The points x(n) of the envelope, in L.
    radius : (k,) float64 array
        The signed radius of curvature in L, h + h″ with respect to the angle of the normal:
        positive on a circle with outward normals, 0 at cusps.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(("2*cos(t)", "2*sin(t)"), "t", (0, "2*pi"), True)
    >>> branches = gm.curves.SupportFunction.of_spline(circle).branches([[3, 0], [0, 1]])
    >>> branches
    CurveBranches(2 branches)
    >>> branches.normal_index, branches.normals.tolist(), branches.support.round(3)
    (array([0, 1]), [[1.0, 0.0], [0.0, 1.0]], array([2., 2.]))
    >>> branches.points.round(3) + 0.0
    array([[2., 0.],
           [0., 2.]])
    >>> branches.radius.round(2), branches.curvature.round(2)
    (array([2., 2.]), array([0.5, 0.5]))

    """

    normal_index: NDArray[np.int64]
    normals: Array
    support: Array
    points: Array
    radius: Array

    @property
    def curvature(self) -> Array:
        """(k,) float64 array: the curvature in 1/L, infinite at cusps."""
        with np.errstate(divide="ignore"):
            return 1.0 / self.radius

    def __len__(self) -> int:
        """Return the total number of branches of all normals."""
        return len(self.support)

    def __repr__(self) -> str:
        return f"CurveBranches({len(self):,} branches)"


class SupportFunction(ABC):
    """The support function h(n) of a planar curve (paper, Sect. 4.1); made by `of_spline`.

    It is the signed distance of the tangent with the normal n from the origin. Several points may
    share a normal, each on a branch of h. Operations on curves are simple operations on their
    support functions: `+` (convolution), `offset`, `translated`, `rotated`, `scaled`, `reversed`.
    They return new objects, which are evaluated lazily. Straight parts of a curve have no branch.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
    >>> ellipse = gm.curves.Curve.from_sympy(("2*cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
    >>> h, other = map(gm.curves.SupportFunction.of_spline, (circle, ellipse))
    >>> (h + other.offset(0.5)).branches([[1, 0]]).support.round(3)
    array([3.5])
    >>> h, h + other.offset(0.5)
    (SupportFunction(curve), SupportFunction(curve + curve, moved))

    """

    @property
    @abstractmethod
    def _label(self) -> str:
        """The name of the curve and of the operations on it."""

    def __repr__(self) -> str:
        return f"SupportFunction({self._label})"

    @staticmethod
    def of_spline(curve: CurveSpline | Curve, pieces: int | None = None) -> SupportFunction:
        """Return the support function of a spline: each point with a normal is on one branch.

        Parameters
        ----------
        curve : CurveSpline or Curve
            A `Curve` is approximated by a spline first.
        pieces : int, optional
            The number of arcs of that spline, see `fit`.

        Returns
        -------
        SupportFunction
            The support function.

        Raises
        ------
        InputError
            For an object that is not a curve, and for `pieces` with a spline.
        SurfaceError
            As `fit`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> eight = gm.curves.Curve.from_sympy(("sin(t)", "sin(2*t)"), "t", (0, "2*pi"), True)
        >>> gm.curves.SupportFunction.of_spline(eight, 32).branches([[0, 1]])
        CurveBranches(2 branches)

        """
        if not isinstance(curve, CurveSpline):
            return OfSpline(fit(curve, pieces))
        if pieces is not None:
            raise InputError("pieces=... is for curves; this spline already has its pieces.")
        return OfSpline(curve)

    def branches(self, normals: ArrayLike) -> CurveBranches:
        """Return all branches at normals.

        Parameters
        ----------
        normals : (S, 2) array_like
            Directions of any length but 0.

        Returns
        -------
        CurveBranches
            One row for each branch, sorted by normal.

        Raises
        ------
        InputError
            For normals that have another shape, are empty, zero, NaN or infinite.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> h = gm.curves.SupportFunction.of_spline(circle)
        >>> h.branches(gm.directions.circle(5)).normal_index
        array([0, 1, 2, 3, 4])

        """
        return self._at(as_normals(normals, 2))

    @abstractmethod
    def _at(self, normals: Array) -> CurveBranches:
        """Return all branches at unit normals (S, 2), sorted by normal."""

    def __add__(self, other: SupportFunction) -> SupportFunction:
        """Return the convolution of two curves: all sums of two points with the same normal."""
        return Sum(self, other) if isinstance(other, SupportFunction) else NotImplemented

    def __radd__(self, other: object) -> SupportFunction:
        """Return 0 + h = h, so that `sum` can add several."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def offset(self, distance: float) -> SupportFunction:
        """Return h + d: the offset curve of the points x + d n.

        Parameters
        ----------
        distance : float
            The distance d; for d < 0 the offset lies inwards, if normals point outwards.

        Returns
        -------
        SupportFunction
            The support function of the offset.

        Raises
        ------
        InputError
            Unless the distance is a finite number.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> inside = gm.curves.SupportFunction.of_spline(circle).offset(-0.25)
        >>> inside.branches([[0, 1]]).points.round(3) + 0.0
        array([[0.  , 0.75]])

        """
        return Moved(self, distance=finite_number(distance, "distance"))

    def translated(self, shift: ArrayLike) -> SupportFunction:
        """Return h + n·t: the curve of the points x + t.

        Parameters
        ----------
        shift : (2,) array_like
            The vector t.

        Returns
        -------
        SupportFunction
            The support function of the translated curve.

        Raises
        ------
        InputError
            Unless t is two finite numbers.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> moved = gm.curves.SupportFunction.of_spline(circle).translated((2, 0))
        >>> moved.branches([[1, 0]]).support.round(3)
        array([3.])

        """
        return Moved(self, shift=finite_array(shift, (2,), "shift"))

    def rotated(self, angle: float) -> SupportFunction:
        """Return h(R⁻¹n): the curve of the points R x, rotated counter-clockwise by an angle.

        Parameters
        ----------
        angle : float
            The angle in degrees.

        Returns
        -------
        SupportFunction
            The support function of the rotated curve.

        Raises
        ------
        InputError
            Unless the angle is a finite number.

        Examples
        --------
        >>> import gaussmap as gm
        >>> ellipse = gm.curves.Curve.from_sympy(("2*cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> turned = gm.curves.SupportFunction.of_spline(ellipse).rotated(90.0)
        >>> turned.branches([[0, 1]]).support.round(3)
        array([2.])

        """
        turn = math.radians(finite_number(angle, "angle"))
        R = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        return Moved(self, motion=R, turn=R)

    def scaled(self, factor: float) -> SupportFunction:
        """Return s h: the curve of the points s x, with the same normals also for s < 0.

        Parameters
        ----------
        factor : float
            The factor s.

        Returns
        -------
        SupportFunction
            The support function of the scaled curve.

        Raises
        ------
        InputError
            Unless s is finite and not 0.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> gm.curves.SupportFunction.of_spline(circle).scaled(3).branches([[1, 0]]).radius.round(1)
        array([3.])

        """
        s = finite_number(factor, "factor")
        if s == 0.0:
            raise InputError("factor must not be 0: the curve would shrink to a point.")
        return Moved(self, motion=s * np.eye(2), growth=s)

    def reversed(self) -> SupportFunction:
        """Return −h(−n): the same curve with the opposite normals.

        Returns
        -------
        SupportFunction
            The support function of the curve with the opposite orientation.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
        >>> h = gm.curves.SupportFunction.of_spline(circle).reversed()
        >>> h.branches([[1, 0]]).points.round(3) + 0.0
        array([[-1.,  0.]])

        """
        return Moved(self, turn=-np.eye(2), growth=-1.0)


@dataclass(frozen=True, eq=False, repr=False)
class OfSpline(SupportFunction):
    """The support functions of all arcs of a spline."""

    spline: CurveSpline

    @property
    def _label(self) -> str:
        return self.spline.name

    def _at(self, normals: Array) -> CurveBranches:
        samples = filled(self.spline, normals, find(self.spline, normals))
        order = np.argsort(samples.normal_index, kind="stable")
        rows = samples.normal_index[order]
        with np.errstate(divide="ignore"):
            radius = 1.0 / samples.curvature[order]
        return CurveBranches(
            rows, normals[rows], samples.support[order], samples.points[order], radius
        )


@dataclass(frozen=True, eq=False, repr=False)
class Sum(SupportFunction):
    """h₁ + h₂: points and radii of curvature add, for each pair of branches at the same normal."""

    first: SupportFunction
    second: SupportFunction

    @property
    def _label(self) -> str:
        return f"{self.first._label} + {self.second._label}"

    def _at(self, normals: Array) -> CurveBranches:
        one, two = self.first._at(normals), self.second._at(normals)
        i, j = pairs(one.normal_index, two.normal_index, len(normals))
        return CurveBranches(
            one.normal_index[i],
            one.normals[i],
            one.support[i] + two.support[j],
            one.points[i] + two.points[j],
            one.radius[i] + two.radius[j],
        )


@dataclass(frozen=True, eq=False, repr=False)
class Moved(SupportFunction):
    """The support function of the points M x + t + d n; n is `turn` times the normal of x.

    M is `motion`, t is `shift`, and d is `distance`. Radii of curvature are multiplied by `growth`,
    then d is added.
    """

    of: SupportFunction
    motion: Array = field(default_factory=partial(np.eye, 2))
    turn: Array = field(default_factory=partial(np.eye, 2))
    shift: Array = field(default_factory=partial(np.zeros, 2))
    distance: float = 0.0
    growth: float = 1.0

    @property
    def _label(self) -> str:
        return f"{self.of._label}, moved"

    def _at(self, normals: Array) -> CurveBranches:
        branches = self.of._at(normals @ self.turn)
        mine = normals[branches.normal_index]
        points = branches.points @ self.motion.T + self.shift + self.distance * mine
        support = np.einsum("kx,kx->k", mine, points)
        radius = self.growth * branches.radius + self.distance
        return replace(branches, normals=mine, support=support, points=points, radius=radius)
