"""Print docs/alignment.md, why rows along lines of curvature need fewer samples, and draw it."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import gaussmap as gm
import numpy as np
from gaussmap.benchmarks.peers.forms import FORMS, Array, ClosedForm
from gaussmap.benchmarks.peers.mesh_metrics import Quality, quality
from gaussmap.benchmarks.peers.metrics import Errors, Places, errors, nearest_by_tree
from gaussmap.benchmarks.peers.untuned import UNTUNED
from gaussmap.benchmarks.quality.surfaces import SmallFillets
from gaussmap.docs import alignment_figure
from gaussmap.docs.alignment_cells import (
    ALIGNED,
    CHORD,
    HEXAGON,
    SIDES,
    cells_table,
    lantern_table,
    stretched_table,
)
from gaussmap.docs.orders import markdown, number, wrapped
from tqdm import tqdm

COUNT = 10_000
PLACES = 100_000
LATTICE = 600  # places along u and v at which integrals are taken
TRIES, NEAR = 4, 0.02  # to find a count for an angle

HEAD = """\
# Rows along lines of curvature: why, and how many samples they save

Written by `make alignment`: do not edit. The constants are derived in `symbolic/cells.py`; every
number of the tables is measured when this page is written.

## Cells

Near a point a surface is z = (κ₁ x² + κ₂ y²)/2 over its tangent plane, |κ₁| ≥ |κ₂|, and its normal
is that of the point, turned by (κ₁ x, κ₂ y). A sample stands for a cell of area A, with N samples
for ∫ dA / N on average. How far do normals turn in the cell?

- In a **hexagon**, the best cell without a direction, by κ₁ R at most; R is its circumradius,
  {hexagon:.3f} √A. With cells of areas such that this is the same everywhere,
  E = {hexagon:.3f} √(∫ κ₁² / N).
- In a **rectangle** with sides p and q along the lines of curvature by ½ √(κ₁² p² + κ₂² q²). For an
  area p q = A this is least for κ₁ p = κ₂ q, and E = {aligned:.3f} √(∫ |K| / N), the constant being
  ½ √2. The two triangles into which a diagonal cuts it deviate as much from the normals at their
  corners: the mesh has the same constant, as both triangles have the normal of the middle.
- **No samples** can have G below {hexagon:.3f} √(∫ |K| / N): they cover the Gaussian image, of area
  ∫ |K|, by disks, and hexagons cover best.

So rows along lines of curvature replace κ₁² by κ₁ κ₂. On a fillet of radius r along an edge of
radius R that is a factor of r / R in N, and nothing is gained where κ₁ = κ₂. A **graded grid** of
parameters has the same lines everywhere, with steps for the fastest turn along each of them:
E = {aligned:.3f} √(L_u L_v / N), where L_u = ∫ max |n_u| du, the maximum over v, and L_v alike.

In space, the triangles of the hexagons are {chord:.3f} κ₁ A away from the surface, and those that
are equilateral in the metric |II| are {chord:.3f} √|K| A away: a Hausdorff distance of
{chord:.3f} ∫ √|K| / N instead of {chord:.3f} ∫ κ₁ / N.

The same, on surfaces that are not quadratic, with cells of sizes h, relative to the smaller radius
of curvature: measured angles and distances, divided by what the constant is multiplied with above.
"""

LANTERN = """\
## Why the direction matters: the lantern of Schwarz

Rectangles with κ₁ p = κ₂ q are squares in the metric III, the angles between normals. It is
tempting to mesh by this metric whatever the directions of triangles are, as anisotropic meshers do.
That fails. Schwarz inscribed triangles into a cylinder, in rings of which each is shifted by half a
step. The normals at their corners never differ by more than a step, but the triangles lean towards
the axis the more, the more rings there are. For {sides} triangles in a ring of a cylinder of radius
and height 1:
"""

STRETCHED = """\
The same happens to any triangle that is stretched and turned. A triangle that is equilateral in III
with circumradius R, an angle, and turned by θ, has a plane that leans across its narrow side by
¼ (κ₁/κ₂ − 1) R cos 3θ, however small it is. The table gives its largest angle to the normals at its
corners, over R: at the best and the worst θ, and for the metric κ₁ |II|, whose triangles are
stretched by √(κ₁/κ₂) only and, where K > 0, never exceed R.
"""

SAFE = """\
So III alone is for cells whose sides run along lines of curvature. The metric that is safe in all
directions, κ₁ |II|, has E = {hexagon:.3f} √(∫ κ₁ √|K| / N), half-way between both. Samples without
triangles know the same: the region nearest in space to a sample of a stretched set is stretched
along the lines of curvature only if the samples stand in rows. Points moved to the centres of
their cells by Lloyd's method in the metric of positions and normals do not.
"""

MEASURED = """\
## Whole surfaces

E for {count:,} samples, in degrees: what perfect cells everywhere would give, and what `gm.sample`
reaches, which is the worst of all cells. **bound** is that of G,
{hexagon:.3f} √(∫ |K| / N), **graded grid** the value with L_u L_v. A
cylinder and a plane have K = 0: there the floor of the target density (λ, see the
[glossary](glossary.md)) decides about the steps along the axis, and no promise is made.
"""

COUNTS = """\
## The same accuracy, and how many vertices

Meshes by `samples.mesh(prefer="normals")`: the worst angle between normals of the surface and of
the mesh of {count:,} samples with `density="balanced"`, the number of samples with
`density="aligned"` whose mesh has about the same worst angle, and the Hausdorff distances of
both.
"""


# --- whole surfaces -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Promise:
    """What the constants promise for COUNT samples, in degrees."""

    balanced: float
    aligned: float
    graded: float
    bound: float

    @classmethod
    def of(cls, form: ClosedForm) -> Promise:
        """Integrate over the surface, by differences of normals."""
        ends = np.array(form.surface.domain)
        size, middle = ends[:, 1] - ends[:, 0], (np.arange(LATTICE) + 0.5) / LATTICE
        u, v = np.meshgrid(*(ends[:, :1] + size[:, None] * middle), indexing="ij")
        step = 1e-6 * size
        (x_u, n_u), (x_v, n_v) = (
            [(b - a) / (2 * h) for a, b in zip(low, high, strict=True)]
            for low, high, h in (
                (form.evaluate(u - step[0], v), form.evaluate(u + step[0], v), step[0]),
                (form.evaluate(u, v - step[1]), form.evaluate(u, v + step[1]), step[1]),
            )
        )
        area, bending = form.area(u, v), form.bending(u, v)
        squares = larger_square(x_u, x_v, n_u, n_v)
        cell = size.prod() / LATTICE**2
        turns = [
            np.linalg.norm(n, axis=-1).max(axis=1 - axis).sum() * size[axis] / LATTICE
            for axis, n in enumerate((n_u, n_v))
        ]
        K = bending.sum() * cell
        found = (
            HEXAGON * math.sqrt((squares * area).sum() * cell),
            ALIGNED * math.sqrt(K),
            ALIGNED * math.sqrt(turns[0] * turns[1]),
            HEXAGON * math.sqrt(K),
        )
        return cls(*(math.degrees(x / math.sqrt(COUNT)) for x in found))


def larger_square(x_u: Array, x_v: Array, n_u: Array, n_v: Array) -> Array:
    """Return κ₁², the larger eigenvalue of III relative to I."""
    E, F, G = dots(x_u, x_u), dots(x_u, x_v), dots(x_v, x_v)
    e, f, g = dots(n_u, n_u), dots(n_u, n_v), dots(n_v, n_v)
    total = (E * g - 2 * F * f + G * e) / (E * G - F * F)
    product = (e * g - f * f) / (E * G - F * F)
    return total / 2 + np.sqrt(np.maximum(total * total / 4 - product, 0.0))


def dots(left: Array, right: Array) -> Array:
    """Return scalar products."""
    return np.einsum("...x,...x->...", left, right)


@dataclass(frozen=True)
class Measurement:
    """What is measured on one surface."""

    form: ClosedForm
    places: Places

    @classmethod
    def of(cls, form: ClosedForm) -> Measurement:
        """Draw the places."""
        return cls(form, Places.of(form, PLACES))

    def errors(self, density: str) -> Errors:
        """Judge samples."""
        found = gm.sample(self.form.surface, count=COUNT, density=density)
        return errors(self.form, self.places, found.points, found.normals, nearest_by_tree)

    def mesh(self, density: str, count: int) -> Quality:
        """Judge a mesh."""
        samples = gm.sample(self.form.surface, count=count, density=density)
        mesh = samples.mesh(prefer="normals")
        return quality(self.form, self.places, (mesh.vertices, mesh.triangles))

    @cached_property
    def meshes(self) -> tuple[Quality, Quality]:
        """Two meshes of the same worst angle: of COUNT samples, and aligned ones."""
        balanced = self.mesh("balanced", COUNT)
        count, tried = float(COUNT), []
        for _ in range(TRIES):
            tried.append(self.mesh("aligned", round(count)))
            count = tried[-1].vertices * (tried[-1].worst / balanced.worst) ** 2
            if abs(tried[-1].worst / balanced.worst - 1.0) < NEAR:
                break
        return balanced, min(tried, key=lambda x: abs(math.log(x.worst / balanced.worst)))


def promises(measured: Sequence[Measurement]) -> str:
    """Return the table of promises and of what comes."""
    header = ["", "balanced", "measured", "aligned", "graded grid", "measured", "bound", "G"]
    rows = []
    for x in measured:
        promise, round_cells, rows_of = (
            Promise.of(x.form),
            x.errors("balanced"),
            x.errors("aligned"),
        )
        values = (
            promise.balanced, round_cells.E, promise.aligned, promise.graded, rows_of.E,
            promise.bound, rows_of.G,
        )  # fmt: skip
        rows.append([x.form.name, *(f"{value:.2f}" for value in values)])
    return markdown(header, rows)


def counts(measured: Sequence[Measurement]) -> str:
    """Return the table of vertices."""
    header = ["", "worst angle", "vertices", "Hausdorff distance", "worst angle, aligned"]
    header += ["vertices, aligned", "Hausdorff distance, aligned", "share"]
    rows = []
    for x in measured:
        cells = []
        for y in x.meshes:
            cells += [f"{y.worst:.2f}", f"{y.vertices:,}", number(y.hausdorff)]
        share = x.meshes[1].vertices / x.meshes[0].vertices
        rows.append([x.form.name, *cells, f"{100 * share:.0f} %"])
    return markdown(header, rows)


def main() -> None:
    """Measure, draw, and print the page."""
    warnings.simplefilter("ignore", gm.GaussmapWarning)
    forms = (*FORMS[:2], UNTUNED[1], SmallFillets())
    measured = [Measurement.of(form) for form in forms]
    for x in tqdm(measured, desc="measuring", disable=None, file=sys.stderr):
        x.meshes  # noqa: B018
    caption = alignment_figure.draw()
    constants = {"hexagon": HEXAGON, "aligned": ALIGNED, "chord": CHORD}
    parts = [
        wrapped(HEAD.format(**constants)), cells_table(),
        wrapped(LANTERN.format(sides=SIDES)), lantern_table(),
        wrapped(STRETCHED), stretched_table(), wrapped(SAFE.format(**constants)),
        wrapped(MEASURED.format(count=COUNT, **constants)), promises(measured),
        wrapped(COUNTS.format(count=COUNT)), counts(measured), caption,
    ]  # fmt: skip
    print("\n".join(parts), end="")


if __name__ == "__main__":
    main()
