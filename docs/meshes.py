"""Print docs/meshes.md: meshes through samples, compared with Gmsh and Open CASCADE."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from statistics import median

import gaussmap as gm
import numpy as np
from gaussmap.benchmarks.peers.forms import FORMS, ClosedForm
from gaussmap.benchmarks.peers.machine import machine
from gaussmap.benchmarks.peers.mesh_metrics import FEW, PARTS, Quality, quality
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.peers.peer import timed
from gaussmap.benchmarks.peers.triangles import (
    Triangles,
    by_grid,
    gmsh_triangles,
    opencascade_triangles,
)
from gaussmap.benchmarks.peers.untuned import Boss
from gaussmap.docs.orders import code, listed, markdown, number, wrapped
from gaussmap.tools.meshes.meshing import triangulated
from gaussmap.tools.meshes.triangulated import Prefer
from matplotlib.cbook import get_sample_data

COUNTS = (2_000, 10_000)
PLACES = 200_000
KINDS: tuple[Prefer, Prefer] = ("shape", "normals")
SHAPED, TERRAIN = 10_000, (50, 43)
TIMED = (10_000, 100_000, 1_000_000)
ROUNDS = 3

OWN = "**`samples.mesh()`**"
NORMALS = '**`samples.mesh(prefer="normals")`**'
GMSH = "Gmsh, curvature size"
DELAUNAY = "the same samples, Delaunay over (u, v)"
# Samples of these densities; the second ones are on graded grids.
BALANCED, ALIGNED = "balanced", "aligned"
GRID = '**the same with `density="aligned"`**'


# --- meshes ---------------------------------------------------------------------------------------


def samples_for(
    form: ClosedForm, count: int, prefer: Prefer, density: str = BALANCED
) -> gm.Samples:
    """Return samples whose mesh has about `count` vertices, those of the border among them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        first = gm.sample(form.surface, count=count, density=density)
        added = len(first.mesh(prefer=prefer).vertices) - len(first)
        return gm.sample(form.surface, count=count - added, density=density)


def by_shape(form: ClosedForm, count: int) -> Triangles:
    """Return the mesh of gaussmap with well-shaped triangles."""
    mesh = samples_for(form, count, "shape").mesh()
    return mesh.vertices, mesh.triangles


def by_normals(form: ClosedForm, count: int) -> Triangles:
    """Return the mesh of gaussmap whose triangles are close to the normals."""
    mesh = samples_for(form, count, "normals").mesh(prefer="normals")
    return mesh.vertices, mesh.triangles


def by_grid_of_samples(form: ClosedForm, count: int) -> Triangles:
    """Return the mesh of gaussmap of samples on a graded grid."""
    mesh = samples_for(form, count, "normals", ALIGNED).mesh(prefer="normals")
    return mesh.vertices, mesh.triangles


def without_flips(form: ClosedForm, count: int) -> Triangles:
    """Return the triangulation from which the flips of gaussmap start."""
    samples = samples_for(form, count, "normals")
    assert samples.spline is not None
    mesh = triangulated(samples, samples.spline).mesh(len(samples))
    return mesh.vertices, mesh.triangles


MESHERS: dict[str, Callable[[ClosedForm, int], Triangles]] = {
    OWN: by_shape,
    NORMALS: by_normals,
    DELAUNAY: without_flips,
    "grid of parameters": by_grid,
    GMSH: gmsh_triangles,
    "Open CASCADE, angular deflection": opencascade_triangles,
}
OF_GRIDS = {GRID: by_grid_of_samples}


# --- the page -------------------------------------------------------------------------------------

HEAD = """\
# Meshes through samples, measured

Written by `make meshes`: do not edit.

Triangle meshes of three surfaces with M vertices, about {counts}. The vertices of `samples.mesh()`
are the samples of `gm.sample(count=…)` and points on open borders, M in all. Those of
`density="aligned"` are on a graded grid, of which each is a vertex.
By default edges are flipped until triangles are Delaunay on the surface,
and samples too close to others are left out; with `prefer="normals"` until no flip reduces the
angles between two triangles and the normals at their corners. The row below both is the
triangulation from which the flips start. In a grid of parameters, each cell is cut along one
diagonal. Gmsh meshes by curvature, Open CASCADE by
angular deflection: the torus is one of their primitives, the other two surfaces are given to them
as cubic B-splines through 61 × 61 points. Vertices that coincide count once. Columns:

- **surface → mesh**: the largest distance of {places:,} points of the exact surface (uniform by
  area) from the mesh, in the unit of the surface;
- **mesh → surface**: the largest distance of {lattice} points on each triangle from the surface;
  the larger one of both is the Hausdorff distance;
- **worst** and **mean angle**: between the normal of a point of the surface and that of the nearest
  triangle, in degrees;
- **shape**: 95 % of the triangles have angles of at least that many degrees.
"""

MEANING = """\
## Results

With M ≈ {last:,} and `prefer="normals"` the mean angle is smaller than that of Gmsh on {mean}, the
worst angle on {worst}, the distance on {distance}; the flips reduce the mean angle by {saved}. The
default has better-shaped triangles than that, and mean angles larger by {cost}.
"""

SHAPES = """\
## Shapes of triangles

Meshes of {count:,} samples
of surfaces that make thin triangles likely: where they are
developable, where regions of different density meet, and where folds of a terrain bring samples of
several patches together. The terrain is that of `make demo`, the boss a solid of CAD with a plate,
fillets and a cylinder. **smallest** angles: the smallest one, that which 5 % of the triangles fall
below, and how many of a thousand are below 5°; **inner** without the triangles at open borders.
**Angles** between triangles and the normals at their corners: mean and worst. **Left out**: samples
that are no vertices.
"""

TIME = """\
## Time

Seconds for `samples.mesh(prefer="normals")` of N samples, the median of {rounds} runs. For those of
the default density most of the time is Qhull's triangulation, which grids do not need:
"""

# Measured once: these files, of Open CASCADE, Gmsh and Netgen, are not in here.
OF_PARTS = """\
## CAD parts

Meshes of CAD files with 8,000 vertices, measured once and not by `make meshes`: the mean angle
between the normals of 150,000 places and those of the nearest triangles, the Hausdorff distance in
% of the diagonal, and the smallest angle; Gmsh's vertices are within 2 %, sizes by curvature, of
each figure the best of three largest sizes.
"""
ROWS_OF_PARTS = (
    ("screw.step", "0.78 / 0.88", "0.021 / 0.019", "25.0 / 32.3"),
    ("CrankArm.brep", "1.78 / 2.19", "0.057 / 0.069", "1.6 / 0.0"),
    ("bottle.brep", "1.19 / 2.34", "0.133 / 0.738", "0.7 / 0.1"),
    ("as1-tu-203.stp", "1.03 / 1.09", "0.101 / 0.100", "19.6 / 14.1"),
    ("hammer.iges", "1.97 / 2.92", "0.065 / 0.074", "3.7 / 1.0"),
)
BY_NORMALS = """\
5 % of our triangles have smaller angles than 27° to 29°, of Gmsh's, 28° to 48°: edges are flipped
to the normals as long as angles stay above 25°, which makes mean angles smaller and triangles
thinner.

With `prefer="normals"` the mean angle is 0.35° on bottle.brep and 0.08° on as1-tu-203.stp, that of
Open CASCADE's with as many vertices, for several deflections, at least 0.52° and 0.11°. Its
distances are smaller: 0.041 % to 0.063 % on the bottle, of ours 0.085 %, and 0.001 % against
0.003 % on as1. 99 % of the angles are below 5.1° on the bottle, of Open CASCADE's below 2.5° to
5.5°, and below 1.2° and 1.4° on as1.
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
        f"{found.small:.1f}",
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
                count: {
                    x: quality(form, places, y(form, count))
                    for x, y in (MESHERS | OF_GRIDS).items()
                }
                for count in COUNTS
            },
        )

    def table(self) -> str:
        """Return the section of the page."""
        header = ["", "M", "surface → mesh", "mesh → surface", "worst angle", "mean angle"]
        header.append("shape")
        rows = [row(title, x) for found in self.found.values() for title, x in found.items()]
        return f"## {self.form.label}\n\n{markdown(header, rows)}"


def meaning(measured: Sequence[Measurement]) -> str:
    """Say where gaussmap is better than Gmsh, and where the flips help, with the largest M."""
    last = COUNTS[-1]
    pairs = {
        x.form.name: tuple(x.found[last][title] for title in (NORMALS, GMSH, DELAUNAY, OWN))
        for x in measured
    }

    def smaller(value: Callable[[Quality], float]) -> str:
        names = [name for name, x in pairs.items() if value(x[0]) < value(x[1])]
        return listed(map(code, names)) if names else "no surface"

    return MEANING.format(
        last=last,
        mean=smaller(lambda x: x.mean),
        worst=smaller(lambda x: x.worst),
        distance=smaller(lambda x: x.hausdorff),
        saved=listed(
            f"{100 * (1 - own.mean / before.mean):.0f} % on {code(name)}"
            for name, (own, _, before, _) in pairs.items()
        ),
        cost=listed(
            f"{100 * (shape.mean / own.mean - 1):.0f} % on {code(name)}"
            for name, (own, _, _, shape) in pairs.items()
        ),
    )


def shapes() -> str:
    """Compare the triangles of both kinds of meshes."""
    header = ["", "prefer", "M", "smallest", "5 %", "< 5°", "inner 5 %", "inner < 5°"]
    header += ["mean angle", "worst", "left out"]
    rows = []
    for name, surface, cells in difficult():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", gm.GaussmapWarning)
            samples = gm.sample(surface, count=SHAPED, cells=cells)
        for prefer in KINDS:
            rows.append([name, prefer, *shape_of(samples, samples.mesh(prefer=prefer))])
    return markdown(header, rows)


def difficult() -> Iterator[tuple[str, gm.Surface, tuple[int, int] | None]]:
    """Yield names, surfaces and cells."""
    for name in ("torus", "cylinder", "sphere"):
        yield name, gm.surfaces.surface(name), None
    yield "boss", Boss().surface, None
    with np.load(get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as data:
        yield "terrain", gm.Surface.from_grid(data["elevation"], spacing=(74.5, -92.5)), TERRAIN


def shape_of(samples: gm.Samples, mesh: gm.Mesh) -> list[str]:
    """Return the figures of one mesh."""
    angles = mesh.smallest_angles
    inner = angles[~np.isin(mesh.triangles, np.unique(mesh.boundary_edges)).any(axis=1)]
    left_out = len(samples) - np.count_nonzero(mesh.sample_index >= 0)
    figures = [f"{len(mesh.vertices):,}", f"{angles.min():.1f}"]
    for x in (angles, inner):
        figures += [f"{np.quantile(x, FEW):.1f}", f"{1000 * (x < 5.0).mean():.1f}"]
    return [*figures, f"{mesh.angles.mean():.2f}", f"{mesh.angles.max():.1f}", f"{left_out:,}"]


def times() -> str:
    """Time the meshes of gaussmap."""
    header = ["", *(f"N = {x:,}" for x in TIMED)]
    rows = [
        [title, *(number(seconds(form, count, density)) for count in TIMED)]
        for form in FORMS
        for density, title in ((BALANCED, form.name), (ALIGNED, f"{form.name}, aligned"))
    ]
    return markdown(header, rows)


def seconds(form: ClosedForm, count: int, density: str) -> float:
    """Return how long a mesh of about `count` samples takes."""
    samples = gm.sample(form.surface, count=count, density=density)
    mesh = partial(samples.mesh, prefer="normals")
    return median(timed(mesh)[0] for _ in range(ROUNDS))


def of_parts() -> str:
    """Return the section on CAD parts."""
    header = ["samples.mesh() / Gmsh", "mean angle", "distance in %", "smallest angle"]
    table = markdown(header, [list(x) for x in ROWS_OF_PARTS])
    return "\n".join([wrapped(OF_PARTS), table, wrapped(BY_NORMALS)])


def main() -> None:
    """Measure everything and print the page."""
    counts = " and ".join(f"{x:,}" for x in COUNTS)
    measured = [Measurement.of(form) for form in FORMS]
    parts = [
        wrapped(HEAD.format(counts=counts, places=PLACES, lattice=lattice())),
        *(x.table() for x in measured),
        wrapped(meaning(measured)),
        wrapped(SHAPES.format(count=SHAPED)),
        shapes(),
        wrapped(TIME.format(rounds=ROUNDS)),
        times(),
        of_parts(),
        "\n".join(machine()) + "\n",
    ]
    print("\n".join(parts), end="")


if __name__ == "__main__":
    main()
