"""The section of docs/orders.md on poles: errors of the spline next to them, cell by cell."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import cast

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.docs.markdown import code, number
from gaussmap.symbolic.surfaces import CATALOGUE, ParametricSurface, u, v
from numpy.typing import ArrayLike, NDArray

__all__ = ["EGG", "REGIONS", "PoleErrors", "measure", "measured", "surfaces", "table"]

Array = NDArray[np.float64]

SPHERE = CATALOGUE["sphere"]
_X, _Y, _Z = (cast(sp.Expr, x.xreplace(SPHERE.defaults)) for x in SPHERE.position)
EGG = ParametricSurface(
    name="egg",
    sentence="The unit sphere (x, y, z), deformed to (x (6/5 + 3z/10), y (4/5 + z/10), "
    "7z/5 + 3x²/10).",
    position=(
        _X * (sp.Rational(6, 5) + 3 * _Z / 10),
        _Y * (sp.Rational(4, 5) + _Z / 10),
        7 * _Z / 5 + 3 * _X**2 / 10,
    ),
    u=u,
    v=v,
    parameters=(),
    domain=SPHERE.domain,
    boundary=SPHERE.boundary,
)
# A rotation without zeros: the poles of a sphere and an ellipsoid are too symmetric to show much.
ROTATION = np.linalg.qr(np.array([[0.7, 0.3, -0.5], [0.2, 0.8, 0.6], [-0.4, 0.5, 0.9]]))[0]
# Rows of cells, counted from a pole, and the part of the domain farther from poles than a quarter
# of it.
REGIONS = ("row 1", "row 2", "rows 3 and 4", "the middle half")
# Places in a cell along u and v; the first of v is next to the pole.
ALONG, ACROSS = np.linspace(0.0, 1.0, 9), np.array([1e-6, 0.125, 0.25, 0.5, 0.75, 1.0])


@dataclass(frozen=True)
class PoleErrors:
    """The largest errors of positions and of normals (in degrees), by region (4,), and at the pole.

    `at_pole` is the angle between the normals of spline and surface at the poles.
    """

    positions: Array
    normals: Array
    at_pole: float


def surfaces() -> list[ParametricSurface]:
    """Return the surfaces that have poles."""
    return [x for x in CATALOGUE.values() if "pole" in x.boundary[1]] + [EGG]


def exact(entry: ParametricSurface, s: ArrayLike, t: ArrayLike) -> tuple[Array, Array]:
    """Return points and unit normals of the rotated surface at its parameters."""
    s, t = np.broadcast_arrays(s, t)
    values = np.stack([np.broadcast_to(x, s.shape) for x in _compiled(entry)(s, t)], axis=-1)
    normals = values[..., 3:] @ ROTATION.T * np.linalg.det(ROTATION)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    return values[..., :3] @ ROTATION.T, normals / np.where(lengths > 0.0, lengths, 1.0)


@cache
def _compiled(entry: ParametricSurface) -> Callable[[Array, Array], list[Array]]:
    """Return the function of the components of position and normal field, not rotated."""
    rows = [x.xreplace(entry.defaults) for x in (*entry.position, *entry.normal_field)]
    return sp.lambdify((entry.u, entry.v), rows, cse=True)


def measure(entry: ParametricSurface, cells: int) -> PoleErrors:
    """Measure the spline of a surface with poles at both ends of v."""
    domain = tuple((float(low), float(high)) for low, high in entry.domain)
    surface = gm.Surface.from_callable(
        lambda s, t: exact(entry, s, t)[0], domain, entry.boundary, name=entry.name
    )
    spline = gm.fit(surface, (cells, cells))
    (s0, s1), (t0, t1) = domain
    s = s0 + (s1 - s0) * (np.arange(cells)[:, None] + ALONG).ravel() / cells
    rows = (range(1), range(1, 2), range(2, 4), range(cells // 4, cells // 2))
    positions, normals = np.zeros(len(rows)), np.zeros(len(rows))
    for k, region in enumerate(rows):
        steps = (np.array(region)[:, None] + ACROSS).ravel() / cells
        for t in (t0 + (t1 - t0) * steps, t1 - (t1 - t0) * steps):
            x, n = exact(entry, s[:, None], t)
            gap = np.linalg.norm(spline.evaluate(s[:, None], t) - x, axis=-1)
            angle = angles(spline.normals(s[:, None], t), n)
            positions[k] = max(positions[k], gap.max())
            normals[k] = max(normals[k], angle.max())
    tiny = 1e-9 * (t1 - t0)
    ends = np.array([t0 + tiny, t1 - tiny])
    at_pole = angles(spline.normals(s0 + 0.1, ends), exact(entry, s0 + 0.1, ends)[1])
    return PoleErrors(positions, normals, float(at_pole.max()))


def angles(left: Array, right: Array) -> Array:
    """Return the angles between unit vectors in degrees, accurate when they are small."""
    return np.degrees(2.0 * np.arcsin(np.linalg.norm(left - right, axis=-1) / 2.0))


def table(grids: Sequence[int], quantity: str) -> list[list[str]]:
    """Return the rows of a table of "positions" or "normals", a header first."""
    header = ["surface", "where", *(f"N = {x}" for x in grids), "slope"]
    rows = [header]
    for entry in surfaces():
        errors = np.array([getattr(measured(entry.name, x), quantity) for x in grids])
        for k, region in enumerate(REGIONS):
            slope = -np.polyfit(np.log(grids), np.log(errors[:, k]), 1)[0]
            rows.append([code(entry.name), region, *map(number, errors[:, k]), f"{slope:.2f}"])
    return rows


@cache
def measured(name: str, cells: int) -> PoleErrors:
    """Return the errors for the surface of that name."""
    return measure(next(x for x in surfaces() if x.name == name), cells)
