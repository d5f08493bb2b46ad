"""Print docs/meshes.md: meshes through samples, compared with Gmsh and Open CASCADE."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import median
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.benchmarks.peers.forms import FORMS, Array, ClosedForm
from gaussmap.benchmarks.peers.machine import machine
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.peers.peer import timed
from gaussmap.benchmarks.peers.triangles import (
    Triangles,
    by_grid,
    gmsh_triangles,
    opencascade_triangles,
)
from gaussmap.docs.orders import (
    TrueSurface,
    angles,
    code,
    lengths,
    listed,
    markdown,
    number,
    wrapped,
)
from gaussmap.runtime.meshes.meshing import Triangulated

COUNTS = (2_000, 10_000)
PLACES = 200_000
PARTS = 6  # every triangle is compared at the barycentric lattice of step 1/PARTS
STEPS = 8  # of Newton's method
TIMED = (10_000, 100_000, 1_000_000)
ROUNDS = 3

OWN = "**`samples.mesh()`**"
GMSH = "Gmsh, curvature size"
DELAUNAY = "the same samples, Delaunay over (u, v)"


# --- meshes ---------------------------------------------------------------------------------------


def samples_for(form: ClosedForm, count: int) -> gm.Samples:
    """Return samples whose mesh has about `count` vertices, those of the border among them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        first = gm.sample(form.surface, count=count)
        added = len(first.mesh().vertices) - len(first)
        return gm.sample(form.surface, count=count - added)


def own(form: ClosedForm, count: int) -> Triangles:
    """Return the mesh of gaussmap."""
    mesh = samples_for(form, count).mesh()
    return mesh.vertices, mesh.triangles


def without_flips(form: ClosedForm, count: int) -> Triangles:
    """Return the triangulation from which the flips of gaussmap start."""
    samples = samples_for(form, count)
    assert samples.spline is not None
    mesh = Triangulated.of(samples, samples.spline).mesh()
    return mesh.vertices, mesh.triangles


MESHERS: dict[str, Callable[[ClosedForm, int], Triangles]] = {
    OWN: own,
    DELAUNAY: without_flips,
    "grid of parameters": by_grid,
    GMSH: gmsh_triangles,
    "Open CASCADE, angular deflection": opencascade_triangles,
}


# --- how far a mesh is from its surface -----------------------------------------------------------


@dataclass(frozen=True)
class Quality:
    """How well a mesh of `vertices` and `triangles` represents a surface.

    Distances are the largest from the surface to the mesh and back, in the unit of the surface;
    `worst` and `mean` are angles between the normals of both, in degrees.
    """

    vertices: int
    triangles: int
    to_mesh: float
    to_surface: float
    worst: float
    mean: float


def quality(form: ClosedForm, places: Places, mesh: Triangles) -> Quality:
    """Compare a mesh with the exact surface."""
    points, triangles = mesh
    cells, nearest = closest(mesh, places.points)
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = angles(normals[cells], places.normals.astype(np.float64))
    return Quality(
        len(points),
        len(triangles),
        float(lengths(nearest - places.points).max()),
        max(float(to_surface(form, part).max()) for part in on_mesh(corners)),
        float(turned.max()),
        float(turned.mean()),
    )


def closest(mesh: Triangles, places: Array) -> tuple[np.ndarray, Array]:
    """Return the nearest triangle of each place, and the nearest point of it (VTK, exact)."""
    import pyvista as pv

    found: Any = pv.PolyData.from_regular_faces(*mesh).find_closest_cell(
        places, return_closest_point=True
    )
    return found


def on_mesh(corners: Array) -> Iterator[Array]:
    """Yield places on all triangles (T, 3, 3): one after the other of their barycentric lattice."""
    for i in range(PARTS + 1):
        for j in range(PARTS + 1 - i):
            yield np.tensordot(corners, [i / PARTS, j / PARTS, 1 - (i + j) / PARTS], ([1], [0]))


@cache
def exact(form: ClosedForm) -> TrueSurface:
    """Return the surface with its exact derivatives."""
    return TrueSurface(form.name, **vars(form))


def to_surface(form: ClosedForm, points: Array) -> Array:
    """Return the distances of points near the surface, by Newton's method for the nearest point.

    A parameter that would leave the domain is held. ArithmeticError if no point is found.
    """
    true = exact(form)
    place = true.unit(np.stack(form.parameters(points), axis=-1).astype(np.float64))
    is_open = np.array([ends[0] == "open" for ends in form.surface.boundary])
    step, away = np.zeros_like(place), points
    for _ in range(STEPS):
        place = np.where(is_open, np.clip(place, 0.0, 1.0), place)
        x, x_s, x_t, x_ss, x_st, x_tt = np.moveaxis(true.derivatives(*place.T, 2), -2, 0)
        away = x - points
        slope = np.stack([dots(away, x_s), dots(away, x_t)], axis=-1)
        held = is_open & np.where(slope > 0.0, place == 0.0, place == 1.0)
        bend = np.empty((len(place), 2, 2))
        bend[:, 0, 0] = np.where(held[:, 0], 1.0, dots(away, x_ss) + dots(x_s, x_s))
        bend[:, 1, 1] = np.where(held[:, 1], 1.0, dots(away, x_tt) + dots(x_t, x_t))
        bend[:, 0, 1] = np.where(held.any(axis=1), 0.0, dots(away, x_st) + dots(x_s, x_t))
        bend[:, 1, 0] = bend[:, 0, 1]
        step = -np.linalg.solve(bend, np.where(held, 0.0, slope)[..., None])[..., 0]
        place = place + step
    if np.abs(step).max() > 1e-6:
        raise ArithmeticError(f"Newton's method fails on {form.name}")
    return lengths(away.astype(np.float64))


def dots(left: Array, right: Array) -> Array:
    """Return the scalar products of vectors (k, 3)."""
    return np.einsum("kx,kx->k", left, right)


# --- the page -------------------------------------------------------------------------------------

HEAD = """\
# Meshes through samples, measured

Written by `make meshes`: do not edit.

Triangle meshes of three surfaces with M vertices, about {counts}. The vertices of `samples.mesh()`
are the samples of `gm.sample(count=…)` ("balanced", see the [glossary](glossary.md)) and points on
open borders, M in all; edges are flipped until no flip reduces the angles between two triangles and
the normals at their corners. The row below it is the triangulation from which the flips start. In a
grid of parameters, each cell is cut along one diagonal. Gmsh meshes by curvature, Open CASCADE by
angular deflection: the torus is one of their primitives, the other two surfaces are given to them
as cubic B-splines through 61 × 61 points. Vertices that coincide count once. Columns:

- **surface → mesh**: the largest distance of {places:,} points of the exact surface (uniform by
  area) from the mesh, in the unit of the surface;
- **mesh → surface**: the largest distance of {lattice} points on each triangle from the surface;
  the larger one of both is the Hausdorff distance;
- **worst** and **mean angle**: between the normal of a point of the surface and that of the nearest
  triangle, in degrees.
"""

MEANING = """\
## Results

With M ≈ {last:,} the mean angle is smaller than that of Gmsh on {mean}, the worst angle on {worst},
the distance on {distance}. The flips reduce the mean angle by {saved}.
"""

TIME = """\
## Time

Seconds for `samples.mesh()` of N samples, the median of {rounds} runs, most of them in Qhull's
triangulation:
"""


def lattice() -> int:
    """Return how many points of a triangle are compared."""
    return (PARTS + 1) * (PARTS + 2) // 2


def row(title: str, found: Quality) -> list[str]:
    """Return one row of a table."""
    return [
        title,
        f"{found.vertices:,}",
        number(found.to_mesh),
        number(found.to_surface),
        f"{found.worst:.1f}",
        f"{found.mean:.2f}",
    ]


@dataclass(frozen=True)
class Measurement:
    """The qualities of all meshes of one surface, by counts and titles."""

    form: ClosedForm
    found: dict[int, dict[str, Quality]]

    @classmethod
    def of(cls, form: ClosedForm) -> Measurement:
        """Measure all meshes of one surface."""
        places = Places.of(form, PLACES)
        return cls(
            form,
            {
                count: {x: quality(form, places, y(form, count)) for x, y in MESHERS.items()}
                for count in COUNTS
            },
        )

    def table(self) -> str:
        """Return the section of the page."""
        header = ["", "M", "surface → mesh", "mesh → surface", "worst angle", "mean angle"]
        rows = [row(title, x) for found in self.found.values() for title, x in found.items()]
        return f"## {self.form.label}\n\n{markdown(header, rows)}"


def meaning(measured: Sequence[Measurement]) -> str:
    """Say where gaussmap is better than Gmsh, and where the flips help, with the largest M."""
    last = COUNTS[-1]
    pairs = {
        x.form.name: tuple(x.found[last][title] for title in (OWN, GMSH, DELAUNAY))
        for x in measured
    }

    def smaller(value: Callable[[Quality], float]) -> str:
        names = [name for name, (own, gmsh, _) in pairs.items() if value(own) < value(gmsh)]
        return listed(map(code, names)) if names else "no surface"

    return MEANING.format(
        last=last,
        mean=smaller(lambda x: x.mean),
        worst=smaller(lambda x: x.worst),
        distance=smaller(lambda x: max(x.to_mesh, x.to_surface)),
        saved=listed(
            f"{100 * (1 - own.mean / before.mean):.0f} % on {code(name)}"
            for name, (own, _, before) in pairs.items()
        ),
    )


def times() -> str:
    """Time the meshes of gaussmap."""
    header = ["", *(f"N = {x:,}" for x in TIMED)]
    rows = [[form.name, *(number(seconds(form, count)) for count in TIMED)] for form in FORMS]
    return markdown(header, rows)


def seconds(form: ClosedForm, count: int) -> float:
    """Return how long a mesh of about `count` samples takes."""
    samples = gm.sample(form.surface, count=count)
    return median(timed(samples.mesh)[0] for _ in range(ROUNDS))


def main() -> None:
    """Measure everything and print the page."""
    counts = " and ".join(f"{x:,}" for x in COUNTS)
    measured = [Measurement.of(form) for form in FORMS]
    parts = [
        wrapped(HEAD.format(counts=counts, places=PLACES, lattice=lattice())),
        *(x.table() for x in measured),
        wrapped(meaning(measured)),
        wrapped(TIME.format(rounds=ROUNDS)),
        times(),
        "\n".join(machine()) + "\n",
    ]
    print("\n".join(parts), end="")


if __name__ == "__main__":
    main()
