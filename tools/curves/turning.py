"""The turning of the normal of a planar curve, from its normals at the joints of arcs."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array


class Turning:
    """A planar curve in P arcs, on each of which the normal turns by less than π."""

    periodic: bool

    @cached_property
    def joint_normals(self) -> Array:
        """Normals (P + 1, 2) at the joints of arcs; they need not be unit vectors."""
        raise NotImplementedError

    @cached_property
    def angles(self) -> tuple[Array, NDArray[np.int64]]:
        """Angles of the normals at the joints, and full turns: (P + 1,) float64 and int64 arrays.

        Angles are in radians, in −π … π. The sum angle + 2π turns follows the curve: on an arc it
        changes by less than π.
        """
        angles = angles_of(self.joint_normals)
        if self.periodic:
            angles[-1] = angles[0]
        steps = np.diff(angles)
        turns = np.cumsum((steps < -np.pi).astype(np.int64) - (steps > np.pi))
        return angles, np.concatenate([[0], turns])

    @cached_property
    def turning_angles(self) -> Array:
        """(P,) float64 array: the angle by which the normal turns on each arc, in radians.

        Its sign is the sign of κ on the arc.
        """
        angles, turns = self.angles
        return np.diff(angles) + 2 * np.pi * np.diff(turns)

    @property
    def turning_number(self) -> int | None:
        """The number of turns of the normal along a closed curve; None for an open curve."""
        return int(self.angles[1][-1]) if self.periodic else None


def angles_of(vectors: Array) -> Array:
    """Return the angles of vectors (k, 2), from −π to π; components −0.0 count as 0.0."""
    return np.arctan2(vectors[:, 1] + 0.0, vectors[:, 0] + 0.0)
