"""The section of docs/orders.md on poles: errors of the spline next to them, cell by cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import cast

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.docs.exact import angles, derivatives_of, lengths
from gaussmap.docs.markdown import code, markdown, number
from gaussmap.symbolic.surfaces import CATALOGUE, ParametricSurface, u, v
from numpy.typing import ArrayLike, NDArray

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
# A rotation matrix without zeros: otherwise, the symmetry of the sphere and of the ellipsoid would
# hide errors at their poles.
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


@cache
def measured(name: str, cells: int) -> PoleErrors:
    """Measure the spline of the surface of that name, which has poles at both ends of v."""
    entry = next(x for x in surfaces() if x.name == name)
    derivatives = derivatives_of(entry)

    def exact(s: ArrayLike, t: ArrayLike) -> tuple[Array, Array]:
        """Return points and normals, not of unit length, of the rotated surface."""
        x, x_s, x_t = np.moveaxis(derivatives(s, t, 1) @ ROTATION.T, -2, 0)
        return x, np.cross(x_s, x_t)

    square = ((0.0, 1.0), (0.0, 1.0))
    surface = gm.Surface.from_callable(
        lambda s, t: exact(s, t)[0], square, entry.boundary, name=entry.name
    )
    spline = gm.fit(surface, (cells, cells))
    s = (np.arange(cells)[:, None] + ALONG).reshape(-1, 1) / cells
    rows = (range(1), range(1, 2), range(2, 4), range(cells // 4, cells // 2))
    positions, normals = np.zeros(len(rows)), np.zeros(len(rows))
    for k, region in enumerate(rows):
        steps = (np.array(region)[:, None] + ACROSS).ravel() / cells
        x, n = exact(s, t := np.concatenate([steps, 1.0 - steps]))
        positions[k] = lengths(spline.evaluate(s, t) - x).max()
        normals[k] = angles(spline.normals(s, t), n).max()
    ends = np.array([1e-9, 1.0 - 1e-9])
    at_pole = angles(spline.normals(0.1, ends), exact(0.1, ends)[1])
    return PoleErrors(positions, normals, float(at_pole.max()))


def table(grids: Sequence[int], quantity: str) -> str:
    """Return the table of "positions" or "normals" next to poles."""
    header = ["surface", "where", *(f"N = {x}" for x in grids), "slope"]
    rows = []
    for entry in surfaces():
        errors = np.array([getattr(measured(entry.name, x), quantity) for x in grids])
        for k, region in enumerate(REGIONS):
            slope = -np.polyfit(np.log(grids), np.log(errors[:, k]), 1)[0]
            rows.append([code(entry.name), region, *map(number, errors[:, k]), f"{slope:.2f}"])
    return markdown(header, rows)
