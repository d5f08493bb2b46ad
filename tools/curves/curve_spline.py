"""The C¹ quadratic spline that approximates a planar curve: its arcs, joints and normals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import curve as formulas
from ...generated.vectors import Arc, PlaneVector
from ...runtime.base.checks import checked_array, real_array, text
from ...runtime.base.errors import InputError
from ...runtime.base.formula_calls import plane_vector, python_function
from ...runtime.base.scales import scale_to_one
from ...runtime.base.tolerances import DIFFERENCE_ERROR
from ...runtime.domain.domain import Interval, checked_interval
from ...runtime.spline.spline import short_label
from .turning import Turning

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class CurveSpline(Turning):
    """A planar C¹ quadratic spline with P pieces of equal parameter length; made by `fit`.

    Joint k is the beginning of piece k.

    Attributes
    ----------
    coefficients : (P + 2, 2) float64 array
        One vector for each piece, and a ghost coefficient at each end, a copy if the curve is
        closed.
    domain : (float, float)
        The interval of the parameter.
    periodic : bool
        Whether the curve is closed.
    name : str
        Label of the curve.

    Examples
    --------
    >>> import gaussmap as gm
    >>> eight = gm.curves.Curve.from_sympy(
    ...     ("sin(t)", "sin(2*t)"), "t", (0, "2*pi"), periodic=True, name="eight"
    ... )
    >>> spline = gm.curves.fit(eight, 32)
    >>> spline.pieces, spline.name, spline.periodic, spline.coefficients.shape
    (32, 'eight', True, (34, 2))
    >>> spline.turning_number, len(spline.inflections)
    (0, 2)
    >>> spline.control_points.shape, spline.joints.shape, spline.joint_normals.shape
    ((32, 3, 2), (33,), (33, 2))
    >>> abs(spline.domain[1] - 32 * spline.step) < 1e-12
    True
    >>> angles, turns = spline.angles
    >>> bool(abs(spline.turning_angles.sum()) < 1e-12), angles.shape, turns.shape
    (True, (33,), (33,))
    >>> bool(spline.straight.any()), bool(spline.reversing.any())
    (False, False)
    >>> spline.scale, spline.noise < 1e-12
    (2.0, True)

    """

    coefficients: Array
    domain: Interval
    periodic: bool
    name: str

    def __post_init__(self) -> None:
        text(self.name, "name")
        object.__setattr__(self, "domain", checked_interval(self.domain))
        checked_array("coefficients", self.coefficients, ("P + 2", 2), np.float64)

    def __repr__(self) -> str:
        return f"CurveSpline({self.pieces:,} pieces of {short_label(self.name)})"

    @property
    def pieces(self) -> int:
        """The number of quadratic arcs."""
        return len(self.coefficients) - 2

    @property
    def step(self) -> float:
        """The length of a piece in the parameter."""
        return (self.domain[1] - self.domain[0]) / self.pieces

    @property
    def joints(self) -> Array:
        """(P + 1,) float64 array: the parameters of the joints, both ends included."""
        return np.linspace(*self.domain, self.pieces + 1)

    @cached_property
    def control_points(self) -> Array:
        """(P, 3, 2) float64 array: the control points of the arcs, in order."""
        mu = self.coefficients
        points = python_function(formulas.arc_control_points)(
            *map(plane_vector, (mu[:-2], mu[1:-1], mu[2:]))
        )
        return np.stack([np.stack(x, axis=-1) for x in points], axis=1)

    @cached_property
    def scale(self) -> float:
        """A power of two that scales differences of neighbouring coefficients to about 1."""
        return scale_to_one(float(np.abs(np.diff(self.coefficients, axis=0)).max()))

    def evaluate(self, t: ArrayLike) -> Array:
        """Return the points of the spline at parameters.

        Parameters
        ----------
        t : array_like
            Parameters; on a closed curve modulo the period.

        Returns
        -------
        (..., 2) float64 array
            The points.

        Raises
        ------
        InputError
            If a parameter of an open curve lies outside the domain, or any is NaN or infinite.

        Examples
        --------
        >>> import gaussmap as gm
        >>> line = gm.curves.fit(gm.curves.Curve.from_sympy(("t", "2*t"), "t", (0, 1)), 4)
        >>> line.evaluate(0.5)
        array([0.5, 1. ])

        """
        return self._evaluate(t)[0]

    def normals(self, t: ArrayLike) -> Array:
        """Return unit normals at parameters: the tangent rotated clockwise by 90°.

        Parameters
        ----------
        t : array_like
            As in `evaluate`.

        Returns
        -------
        (..., 2) float64 array
            The normals; NaN at singular points.

        Raises
        ------
        InputError
            As `evaluate`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> line = gm.curves.fit(gm.curves.Curve.from_sympy(("t", "0"), "t", (0, 1)), 4)
        >>> line.normals(0.5) + 0.0
        array([ 0., -1.])

        """
        vectors = self._evaluate(t)[1]
        with np.errstate(invalid="ignore"):
            vectors /= np.abs(vectors).max(axis=-1, keepdims=True)
            return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    def curvature(self, t: ArrayLike) -> Array:
        """Return signed curvatures at parameters, positive on a circle with outward normals.

        Parameters
        ----------
        t : array_like
            As in `evaluate`.

        Returns
        -------
        (...) float64 array
            The curvatures, in 1/L. They jump at joints, where the value of the following arc is
            returned. NaN or infinite at singular points.

        Raises
        ------
        InputError
            As `evaluate`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(
        ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True
        ... )
        >>> gm.curves.fit(circle).curvature([0.0, 1.0]).round(1)
        array([1., 1.])

        """
        return self._evaluate(t)[2]

    # --- how the normal turns ---------------------------------------------------------------------

    @cached_property
    def joint_normals(self) -> Array:
        """(P + 1, 2) float64 array: normals at the joints, multiplied by `scale`.

        They are not unit vectors. Both arcs at a joint share its normal, and so do both ends of a
        closed curve.
        """
        tangents = self.scale * np.diff(self.coefficients, axis=0)
        zero = PlaneVector(0.0, 0.0)
        arcs = Arc(zero, plane_vector(tangents), zero)
        _, *normals = python_function(formulas.arc_tangent)(arcs, 0.0)
        return np.stack(normals, axis=-1)

    @cached_property
    def noise(self) -> float:
        """A bound of the rounding error in a vector of `joint_normals`."""
        return DIFFERENCE_ERROR * float(np.spacing(np.abs(self.coefficients).max())) * self.scale

    @cached_property
    def straight(self) -> NDArray[np.bool_]:
        """(P,) bool array: whether arcs are straight, up to the rounding of their coordinates."""
        before, after = self.joint_normals[:-1], self.joint_normals[1:]
        area = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        return np.abs(area) <= self.noise * (_lengths(before) + _lengths(after))

    @property
    def reversing(self) -> NDArray[np.bool_]:
        """(P,) bool array: whether arcs are straight and have a singular point.

        There the curve reverses its direction or stops.
        """
        before, after = self.joint_normals[:-1], self.joint_normals[1:]
        return self.straight & (np.einsum("kx,kx->k", before, after) <= 0.0)

    @cached_property
    def inflections(self) -> Array:
        """(k,) float64 array: the parameters where the curvature changes its sign, ascending.

        Arcs are parabolas without inflections: inflections are joints, or midpoints of straight
        stretches.
        """
        curved = np.flatnonzero(~self.straight)
        ends = np.roll(curved, -1)
        ends[-1:] += self.pieces
        if not self.periodic:
            curved, ends = curved[:-1], ends[:-1]
        positive = self.turning_angles > 0.0
        changes = positive[curved] != positive[ends % self.pieces]
        places = np.mod((curved[changes] + 1 + ends[changes]) / 2, self.pieces)
        return self.domain[0] + self.step * np.sort(places)

    # --- reading ----------------------------------------------------------------------------------

    def _evaluate(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        array = real_array(t, "t")
        places = self._places(array.ravel())
        piece = np.clip(np.floor(places).astype(np.int64), 0, self.pieces - 1)
        arcs, within = self._arcs(piece), places - piece
        x = python_function(formulas.arc_envelope)(arcs, within)
        tangent, *normal = python_function(formulas.arc_tangent)(arcs, within)
        with np.errstate(all="ignore"):  # at singular points
            lengths = np.hypot(*normal)
            A = (arcs.a.x * normal[0] + arcs.a.y * normal[1]) / lengths
            curvatures = self.scale * python_function(formulas.arc_curvature)(A, tangent)
        points = self.coefficients[piece + 1] + np.stack(x, axis=-1) / self.scale
        shape = array.shape
        return (
            points.reshape(*shape, 2),
            np.stack(normal, axis=-1).reshape(*shape, 2),
            curvatures.reshape(shape),
        )

    def _arcs(self, piece: NDArray[np.int64]) -> Arc:
        """Return the arcs of the pieces with the indices (k,), multiplied by `scale`.

        The points of a piece are relative to its coefficient.
        """
        steps = self.scale * np.diff(self.coefficients, axis=0)
        return python_function(formulas.arc)(
            plane_vector(-steps[piece]), plane_vector(steps[piece + 1])
        )

    def _places(self, t: Array) -> Array:
        """Return for each parameter the index of its piece plus the fraction within the piece.

        Raises InputError for a parameter outside the domain.
        """
        places = (t - self.domain[0]) / self.step
        if self.periodic:
            with np.errstate(invalid="ignore"):
                turns = np.where(places == self.pieces, 0.0, np.floor(places / self.pieces))
                places = places - turns * self.pieces
        slack = 1e-9 * self.pieces
        inside = (places >= -slack) & (places <= self.pieces + slack)
        if not inside.all():
            worst = int(np.argmin(inside))
            raise InputError(
                f"t = {t[worst]} lies outside the domain {self.domain} of {self.name!r}."
            )
        return places


def _lengths(vectors: Array) -> Array:
    return np.hypot(vectors[:, 0], vectors[:, 1])
