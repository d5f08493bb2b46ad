"""The discs around the poles of a surface: bounds in charts without a singularity.

In polar coordinates φ, r at a pole the derivatives by s = r cos φ, t = r sin φ hold quotients by r.
By Taylor's theorem these are derivatives, too: x_φ is 0 for r = 0, so that

    (x_φr − x_φ / r) / r = x_φrr(r₁) − ½ x_φrr(r₂),
    (x_φφ / r + x_r) / r = ½ x_φφrr(r₃) + x_rr(r₄)

at some r₁, …, r₄ between 0 and r, for each coordinate; for the second one, x_φφr = −x_r for r = 0.
Both are consequences of the smoothness of the surface at the pole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...generated.jet import at_pole, polar_chart
from ...generated.vectors import Patch, Vector
from ..base.formula_calls import python_function, vector
from ..domain.domain import Domain
from ..kernels.proved_cells import REST_S, REST_T, WIDE, Cells, write_one_cone
from ..kernels.proved_discs import RINGS, WHOLE, Disc
from ..kernels.tape import Tape, points_jets
from ..kernels.tape_balls import BALL
from ..kernels.tape_rounding import rounding_of_boxes
from ..surface.polar_tapes import PolarTapes, polar_tapes
from ..surface.tapes import bounds_over_boxes

__all__ = ["PoleDisc", "pole_disc"]

Array = NDArray[np.float64]

SECTORS = 512
# Discs that are this many times smaller than a row of cells are tried.
SMALLEST = 2.0**-8
# The Hessian may change by this part of it in a disc.
CHANGE = 0.4
# Derivatives at a pole are those of a smooth surface up to this part of them.
SMOOTH = 1e-9


@dataclass(frozen=True, eq=False)
class PoleDisc:
    """The disc around a pole: its radius, its tape in polar coordinates, bounds, and its cell."""

    radius: float
    tape: Tape
    disc: Disc
    cell: Cells


def pole_disc(tape: Tape, domain: Domain, angle: int, end: float, radius: float) -> PoleDisc | None:
    """Return a disc around a pole of at most some radius; None if the surface is not smooth there.

    Parameter number `angle` runs around the pole, the other one is `end` there.
    """
    tapes = polar_tapes(tape, domain, angle, end)
    if tapes is None or not _is_smooth(tapes):
        return None
    low, high = domain[angle]
    inward = 1.0 if end == domain[1 - angle][0] else -1.0
    turned = inward if angle == 1 else -inward
    size = radius
    while size >= SMALLEST * radius:
        hot, changes, noise = _bounds(tapes, size)
        cell = _cell(hot, changes, noise, turned, size)
        if cell is not None:
            frame = np.array([*noise, size, low, high - low, end, inward, float(angle)])
            return PoleDisc(size, tapes.position, Disc(hot[None], changes, frame), cell)
        size *= 0.5
    return None


def _is_smooth(tapes: PolarTapes) -> bool:
    """Say whether x_φ and x_φφr + x_r vanish at the pole, for some angles, and x is one point."""
    places = np.column_stack([np.linspace(0.3, 6.1, 7), np.zeros(7)])
    middle = bounds_over_boxes(tapes.position, places, np.zeros_like(places), 3)[:, 0]
    slope = bounds_over_boxes(tapes.slope, places, np.zeros_like(places), 3)[:, 0]
    size = np.abs(middle[:, 2]).max()
    rests = (np.ptp(middle[:, 0], axis=0), slope[:, 0], slope[:, 4] + middle[:, 2])
    return bool(size > 0.0 and all(np.abs(x).max() <= SMOOTH * size for x in rests))


def _bounds(tapes: PolarTapes, size: float) -> tuple[Array, Array, Array]:
    """Return `hot`, `changes` and the rounding of x_r and x_φ of a disc; see `Disc`."""
    jets, registers = np.empty((3, 6, 3)), np.empty(BALL * (len(tapes.position.operations) + 1))
    points_jets(tapes.position, np.array([0.0, 0.25, 0.5]) * math.pi, np.zeros(3), registers, jets)
    along = (vector(jets[k, order]) for k, order in ((0, 2), (0, 5), (1, 5), (2, 2), (2, 5)))
    a, b, c, d, e = (np.array(x) for x in python_function(at_pole)(*along))
    hessian = np.stack([a, b, c])
    changes = np.stack([_changes(tapes, WHOLE * size * 0.5**k, hessian) for k in range(RINGS)])
    middles, radii, errors = np.empty((3, len(registers)))
    box = np.array([[math.pi, 0.5 * WHOLE * size]])
    noise = np.empty((1, 6, 3))
    rounding_of_boxes(
        tapes.position, box, box * (1.0 + 1e-12), middles, radii, errors, np.empty((2, 4)), noise
    )
    lengths = np.linalg.norm(noise[0, 1:3] + 2.0**-50 * np.abs(np.stack([d, d])), axis=1)
    hot = np.concatenate([size**2 * a, size**2 * b, size**2 * c, size * d, size * e])
    return hot, size**2 * changes, np.array([lengths[1], lengths[0]])


def _changes(tapes: PolarTapes, reach: float, hessian: Array) -> Array:
    """Return how far second derivatives (3, 3) by s and t may be from those at the pole."""
    half = math.pi / SECTORS
    phi = half * (2.0 * np.arange(SECTORS) + 1.0)
    centres = np.column_stack([phi, np.full(SECTORS, 0.5 * reach)])
    half_widths = np.full_like(centres, half * (1.0 + 1e-12))
    half_widths[:, 1] = 0.5 * reach * (1.0 + 1e-12)
    position = bounds_over_boxes(tapes.position, centres, half_widths, 3)
    slope = bounds_over_boxes(tapes.slope, centres, half_widths, 3)
    along, mixed = 2.0 * position[:, :, 5], position[:, :, 8] * np.array([[1.0], [3.0]])
    across = along + slope[:, :, 8]
    zero = Vector(0.0, 0.0, 0.0)
    values = python_function(polar_chart)(
        Patch(vector(across[:, 0]), vector(mixed[:, 0]), vector(along[:, 0]), zero, zero, zero),
        1.0, np.cos(phi), np.sin(phi),
    )  # fmt: skip
    middles = np.stack([np.stack(x, axis=-1) for x in values[:3]], axis=1)
    # Rotations by the half width of a sector, and the radii of the three derivatives.
    sizes = (np.abs(x[:, 0]) + x[:, 1] for x in (along, mixed, mixed, across))
    turned = sum(sizes) * half
    radii = along[:, 1] + mixed[:, 1] + across[:, 1] + turned
    off = np.abs(middles - hessian) + radii[:, None]
    return off.max(axis=0) * (1.0 + 1e-12)


def _cell(hot: Array, changes: Array, noise: Array, turned: float, size: float) -> Cells | None:
    """Return a disc as a cell with a cone of normals; None if that is wide or K may be 0."""
    if not np.isfinite(changes).all() or not np.isfinite(noise).all():
        return None
    cell = Cells.new(1)
    cell.hot[0, :15] = hot
    a, b, c = np.linalg.norm(changes[1], axis=1)  # for r ≤ 1
    pad = noise[0] * size + 2.0**-48 * np.abs(hot).max()
    cell.hot[0, REST_S], cell.hot[0, REST_T] = a + b + pad, b + c + pad
    write_one_cone(cell)
    axis, chord = cell.cone[0, :3].copy(), cell.cone[0, 3]
    cell.cone[0, :3] *= turned
    y11, y12, y22 = hot[:9].reshape(3, 3) @ axis
    hessian = np.array([[y11, y12], [y12, y22]])
    if chord >= WIDE or np.linalg.det(hessian) == 0.0:
        return None
    a, b, c = changes[0] @ np.abs(axis)
    rows = np.abs(np.linalg.inv(hessian)) @ np.array([a + b, b + c])
    return cell if rows.max() < CHANGE else None
