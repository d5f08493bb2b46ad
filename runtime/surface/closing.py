"""Checks that a surface closes at its declared seams and poles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.errors import SurfaceError
from ..base.evaluation import returned
from ..base.scales import apart, not_too_large
from ..domain.domain import closes
from ..spline.poles import broken_poles
from .surface_values import SurfaceValues

__all__ = ["close_seams", "closed_points"]

# If the points at the two bounds of a parameter differ, points are computed this many units in the
# last place away from the bounds.
ROUNDINGS = 2.0


def closed_points(surface: SurfaceValues, cells: tuple[int, int]) -> NDArray[np.float64]:
    """Return points (m + 1, n + 1, 3) of a surface at the corners of m × n cells of its domain.

    Raises the SurfaceErrors of `close_seams`, and one if coordinates are too large to compute with.
    """
    u, v = (
        np.linspace(*ends, count + 1) for ends, count in zip(surface.domain, cells, strict=True)
    )
    points = not_too_large(surface.evaluate(u[:, None], v), surface.name)
    close_seams(surface, points)
    return points


def close_seams(surface: SurfaceValues, vertices: NDArray[np.float64]) -> None:
    """Make the two rows of `vertices` (m + 1, n + 1, 3) at a seam equal: the spline then closes.

    Raises SurfaceError if the rows differ by more than rounding, or if a pole is not collapsed.
    """
    for axis, (along, ends) in enumerate(zip("uv", surface.boundary, strict=True)):
        rows = np.swapaxes(vertices, 0, axis)
        if closes(ends):
            first = rows[0] if ends[0] == "periodic" else rows[0, ::-1].copy()
            if apart(rows[-1], first, vertices):
                how, other = "the same", "the same, mirrored"
                if ends[0] == "mirrored":
                    how, other = other, how
                if apart(rows[-1], first[::-1], vertices):
                    why = _by_rounding(surface, axis, rows, float(np.abs(rows[-1] - first).max()))
                else:
                    word = "mirrored" if ends[0] == "periodic" else "periodic"
                    why = f'; they are {other}: "{word}" in periodic=(...) says so'
                raise SurfaceError(
                    f"surface {surface.name!r} does not close along {along}: its two ends must be "
                    f"{how}{why}."
                )
            rows[-1] = first
        for end in broken_poles(vertices, surface.boundary, axis):
            raise SurfaceError(
                f"surface {surface.name!r} has no pole at {along} = {surface.domain[axis][end]}: "
                "this side of its domain is not one point."
            )


def _by_rounding(surface: SurfaceValues, axis: int, rows: NDArray[np.float64], far: float) -> str:
    """Return the clause of a message on the distance `far` between the points at both bounds.

    It says whether the rounding error of the parameter explains this distance: 2π, for example, is
    not a float64 number.
    """
    low, high = surface.domain[axis]
    first, last = rows[0], rows[-1]
    other = np.linspace(*surface.domain[1 - axis], len(last))
    moved = 0.0
    step = ROUNDINGS * float(np.spacing(max(abs(low), abs(high))))
    for end, row in ((low + step, first), (high - step, last), (high + step, last)):
        near = np.full(len(last), end)
        places = (near, other) if axis == 0 else (other, near)
        points = returned(surface.function, places, (3,), f"surface {surface.name!r}")
        moved = max(moved, float(np.nanmax(np.abs(points - row))))
    along = "uv"[axis]
    if not moved >= 0.5 * far:
        return f"; they differ by {far:.3g}"
    return (
        f"; they differ by {far:.3g}, as much as its rounding changes the points there: "
        f"compute them at {along} = {low!r} in place of {high!r}"
    )
