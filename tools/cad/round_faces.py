"""All points with given normals on planes, cylinders, cones, spheres and tori, in closed form.

A face is mapped from its own frame to space by x → M x + p. A normal n in space is m = Mᵀ n in its
own frame, up to the length, for any invertible M. In its own frame, x_u × x_v is q (cos u cos w,
sin u cos w, sin w). Here w is v on spheres and tori, and minus the half angle on cylinders and
cones; the formulas `torus_normal` and `cone_normal` give the factor q. So u and w are the longitude
and the latitude of m where q > 0, and of −m where q < 0, computed by `arctan2`.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.faces import cone_normal, torus_normal
from ...runtime.base.formula_calls import python_function
from ...runtime.domain.domain import Domain, Interval
from ...runtime.proof.kernels.answers import KINDS
from .face_places import NOTHING, FacePlaces, joined, undecided
from .records import Geometry

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

ROUND = ("plane", "cylinder", "cone", "sphere", "torus")
TURN = 2.0 * math.pi
EPS = 2.0**-52
# The error of angles of Mᵀ n is at most this times the condition number of M: products of three
# terms, roots and inverse trigonometric functions of the C library have a few roundings each.
ANGLE_ERROR = 16.0 * EPS
# Before angles are computed, normals n are rejected if they are far from the normal p of a plane,
# n·p ≤ 1 − NEAR, or from the normals of a cylinder with axis a, |n·a| > NEAR.
NEAR = 1e-6
CURVE, OPEN_BOX = KINDS.index("curve"), KINDS.index("open")


class Angles(NamedTuple):
    """Parameters u, v (k,) for the normals with indices `numbers` (k,), and bounds of errors."""

    numbers: Indices
    u: Array
    v: Array
    of_u: Array
    of_v: Array

    def at(self, rows: NDArray[np.bool_]) -> Angles:
        """Return a selection of rows."""
        return Angles._make(x[rows] for x in self)

    def within(self, interval: Interval, axis: int) -> Angles:
        """Return the rows whose u (axis 0) or v (axis 1) is in an interval, modulo whole turns."""
        (low, high), values, radius = interval, self[1 + axis], self[3 + axis]
        found = []
        for turn in range(1 + int((high - low) / TURN)):
            first = np.ceil((low - radius - values) / TURN)
            moved = values + TURN * (first + turn)
            rows = (moved <= high + radius) & ((turn == 0) | (moved < high - radius))
            part = list(self.at(rows))
            part[1 + axis] = np.clip(moved[rows], low, high)
            found.append(part)
        return Angles._make(map(np.concatenate, zip(*found, strict=True)))

    @classmethod
    def on_lines(cls, numbers: Indices, domain: Domain) -> Angles:
        """Return one row for each of the indices of normals, which covers the whole domain.

        The parameters are the middle of the domain, and the bounds of errors half of its size.
        """
        (u, of_u), (v, of_v) = (whole(x, len(numbers)) for x in domain)
        return cls(numbers, u, v, of_u, of_v)

    def places(self, sign: float) -> FacePlaces:
        """Return the rows as points whose Gaussian curvature has the given sign."""
        uv, radius = np.stack([self.u, self.v], axis=1), np.stack([self.of_u, self.of_v], axis=1)
        return FacePlaces(self.numbers, uv, radius, np.full(len(uv), sign), NOTHING.undecided)

    def boxes(self, kind: int, domain: Domain) -> FacePlaces:
        """Return the rows as undecided boxes, cut at the bounds of a domain."""
        (u0, u1), (v0, v1) = domain
        sides = self.u - self.of_u, self.u + self.of_u, self.v - self.of_v, self.v + self.of_v
        ends = np.array([u0, u0, v0, v0]), np.array([u1, u1, v1, v1])
        boxes = np.clip(np.stack(sides, axis=1), *ends)
        return NOTHING._replace(undecided=undecided(self.numbers, boxes, kind, border=True))


def whole(interval: Interval, count: int) -> tuple[Array, Array]:
    """Return the middle of an interval and half of its length, (k,) each."""
    low, high = interval
    return np.full(count, (low + high) / 2.0), np.full(count, (high - low) / 2.0)


@dataclass(frozen=True, eq=False)
class RoundFace:
    """A plane, cylinder, cone, sphere or torus over a domain; with `is_reversed`, u is reversed.

    `sizes` are the radius and the half angle of a cylinder or cone, or both radii of a torus.
    `frame` is M, or −M if normals are opposite to M⁻ᵀ m, and `error` bounds the error of the angles
    of Mᵀ n; see the module for M and m.
    """

    kind: str
    sizes: tuple[float, float]
    frame: Array
    error: float
    domain: Domain
    is_reversed: bool

    @classmethod
    def of(cls, geometry: Geometry, domain: Domain, *, is_reversed: bool) -> RoundFace:
        """Return the face of a geometry over a domain."""
        matrix, numbers = geometry.numbers[3:12].reshape(3, 3).T, geometry.numbers[12:].tolist()
        inverse = np.linalg.inv(matrix)
        error = ANGLE_ERROR * math.sqrt(float((matrix**2).sum() * (inverse**2).sum()))
        outward = (np.cross(matrix[:, 0], matrix[:, 1]) @ matrix[:, 2] > 0.0) != is_reversed
        sizes = {1: (0.0, *numbers), 2: tuple(numbers)}.get(len(numbers), (0.0, 0.0))
        if geometry.kind == "cylinder":
            sizes = sizes[::-1]
        frame = matrix if outward else -matrix
        return cls(geometry.kind, sizes, frame, error, domain, is_reversed)

    def query(self, normals: Array, threads: int | None = None) -> FacePlaces:
        """Return all points with unit normals (S, 3)."""
        if self.kind in ("sphere", "torus"):
            found = self._on_circles(normals)
        else:
            found = self._on_plane(normals) if self.kind == "plane" else self._on_rulings(normals)
        return found.reversed_in(sum(self.domain[0])) if self.is_reversed else found

    def _on_plane(self, normals: Array) -> FacePlaces:
        """Return the whole domain as an undecided box, for each normal that the plane has."""
        normal = np.cross(self.frame[:, 0], self.frame[:, 1])
        normal *= math.copysign(1.0, normal @ self.frame[:, 2]) / math.sqrt(normal @ normal)
        (near,) = np.nonzero(normals @ normal > 1.0 - NEAR)
        if not len(near):
            return NOTHING
        own = normals[near] @ self.frame
        near = near[np.hypot(own[:, 0], own[:, 1]) <= self.error * own[:, 2]]
        return Angles.on_lines(near, self.domain).boxes(CURVE, self.domain)

    def _on_rulings(self, normals: Array) -> FacePlaces:
        """Return undecided boxes around the rulings with normals (S, 3) of a cylinder or cone.

        The rulings on both sides of an apex are found.
        """
        radius, angle = self.sizes
        quotient, found = python_function(cone_normal), [NOTHING]
        first, last = quotient(radius, math.sin(angle), np.array(self.domain[1])).tolist()
        low, high = self.domain[1]
        apex = low + (high - low) * first / (first - last) if first * last < 0.0 else low
        for sign in sorted({math.copysign(1.0, x) for x in (first, last)}):
            near = np.arange(len(normals))
            if angle == 0.0:
                size = NEAR * math.sqrt(float((self.frame**2).sum()))
                (near,) = np.nonzero(np.abs(normals @ self.frame[:, 2]) <= size)
            own = sign * normals[near] @ self.frame
            slopes = np.arctan2(own[:, 2], np.hypot(own[:, 0], own[:, 1]))
            rows = np.abs(slopes + angle) <= self.error
            if not rows.any():
                continue
            along = (low if sign * first > 0.0 else apex, high if sign * last > 0.0 else apex)
            part = Angles.on_lines(near[rows], (self.domain[0], along))._replace(
                u=np.arctan2(own[rows, 1], own[rows, 0]),
                of_u=np.full(rows.sum(), self.error / math.cos(angle)),
            )
            found.append(part.within(self.domain[0], 0).boxes(CURVE, self.domain))
        return joined(found)

    def _on_circles(self, normals: Array) -> FacePlaces:
        """Return the points of a torus, or of a sphere, which is a torus with first radius 0."""
        (major, minor), own, found = self.sizes, normals @ self.frame, list[FacePlaces]()
        if self.kind == "sphere":
            return self._at_angles(own, 1.0).places(1.0)
        sides = [math.copysign(1.0, major * minor)] if abs(major) > abs(minor) else [1.0, -1.0]
        for side, sign in itertools.product(sides, (1.0, -1.0)):  # signs of q and cos v
            part = self._at_angles(side * own, sign)
            sizes = side * python_function(torus_normal)(major, minor, np.cos(part.v))
            noise = 4.0 * self.error * (abs(major) + abs(minor)) * abs(minor)
            on_axis = part.of_u >= TURN
            found += [
                part.at(~on_axis & (sizes > noise)).places(side * sign),
                part.at(~on_axis & (np.abs(sizes) <= noise)).boxes(OPEN_BOX, self.domain),
            ]
            if sign > 0.0 and on_axis.any():
                circles = part.at(on_axis & (sizes > -noise))
                u, of_u = whole(self.domain[0], len(circles.u))
                found.append(circles._replace(u=u, of_u=of_u).boxes(CURVE, self.domain))
        return joined(found)

    def _at_angles(self, own: Array, sign: float) -> Angles:
        """Return the parameters with normals `own` (k, 3) at which cos v has the given sign.

        The normals are given in the frame of the face. For a normal near the axis, u is unknown,
        and its error bound is a whole turn.
        """
        across = np.hypot(own[:, 0], own[:, 1])
        u, v = np.arctan2(sign * own[:, 1], sign * own[:, 0]), np.arctan2(own[:, 2], sign * across)
        part = self.error * np.linalg.norm(own, axis=1)
        of_u = np.full(len(u), TURN)
        np.divide(part, across, out=of_u, where=across * TURN > part)
        found = Angles(np.arange(len(u)), u, v, of_u, np.full(len(v), self.error))
        return found.within(self.domain[1], 1).within(self.domain[0], 0)
