"""Figs. 2 and 3: a quadratic triangular patch, and the domain of its support function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import gaussmap as gm
import numpy as np
from gaussmap.docs.drawing import MESH, TINTS, Floats, Globe, Picture, panels
from gaussmap.generated import patch as formulas
from gaussmap.generated.vectors import Patch as Vectors
from gaussmap.runtime.base.formula_calls import python_function, vector
from gaussmap.tools.pictures.palette import INK
from gaussmap.tools.pictures.scene import Scene, quadrangles, view
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

INDICES = ("200", "020", "002", "110", "101", "011")
LEGS = ((0, 3), (3, 1), (1, 5), (5, 2), (2, 4), (4, 0), (3, 4), (3, 5), (4, 5))  # of the net
# The edges by their equations: the indices of their control points, and their colours. With any
# kind of colour blindness these three colours differ by at least 30 in CIELAB.
EDGES = {
    "u = 0": ((1, 5, 2), "#000000"),
    "v = 0": ((0, 4, 2), "#009e73"),
    "w = 0": ((0, 3, 1), "#aa4499"),
}
SIDE = 28.0, 48.0  # from where the first patch is seen: elevation and azimuth in degrees


@dataclass(frozen=True, eq=False)
class Patch:
    """A quadratic Bézier triangle with the control net (6, 3)."""

    net: Floats

    @classmethod
    def of(cls, surface: Callable[[Floats], Floats], corners: Floats) -> Patch:
        """Return the part of a quadratic surface over a triangle (3, 2), by its blossom."""
        x, y = corners[[0, 1, 2, 0, 0, 1]], corners[[0, 1, 2, 1, 2, 2]]
        return cls(2 * surface((x + y) / 2) - (surface(x) + surface(y)) / 2)

    @cached_property
    def vectors(self) -> Vectors:
        """The vectors a, …, e, p."""
        return python_function(formulas.power_form)(*map(vector, self.net))

    @cached_property
    def control_normals(self) -> Floats:
        """The Bézier net (6, 3) of the normal field."""
        normals = np.array(python_function(formulas.control_normals)(self.vectors))
        return normals[[0, 3, 5, 1, 2, 4]]  # they come as 200, 110, 101, 020, 011, 002

    @cached_property
    def mesh(self) -> Floats:
        """Barycentric coordinates (MESH + 1, MESH + 1, 3), from the corner w = 1 outwards."""
        s, t = np.meshgrid(*2 * [np.linspace(0.0, 1.0, MESH + 1)], indexing="ij")
        return np.stack([s * (1 - t), s * t, 1 - s], axis=-1)

    @cached_property
    def image(self) -> gm.gauss_map.GaussianImage:
        """The Gaussian image."""
        return gm.gauss_map.GaussianImage.of_patch(self.net)

    @cached_property
    def tints(self) -> Floats:
        """A colour for each quadrangle of the mesh: blue where it is elliptic, else orange."""
        normals = bezier(self.control_normals, quadrangles(self.mesh).mean(axis=1))
        D = python_function(formulas.forms)(self.vectors, vector(normals))[0]
        return TINTS[1 + np.sign(D).astype(int)]


def bezier(net: Floats, at: Floats) -> Floats:
    """Evaluate a quadratic Bézier triangle at barycentric coordinates (…, 3)."""
    u, v, w = np.moveaxis(at, -1, 0)[..., None]
    terms = (u * u, v * v, w * w, 2 * u * v, 2 * u * w, 2 * v * w)
    return sum((x * y for x, y in zip(terms, net, strict=True)), start=np.zeros(3))


def unit(vectors: Floats) -> Floats:
    """Return vectors with length 1, NaN in the place of 0."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 1e-9, length, np.nan)


# The control points of formula (12), see errata.md.
PATCH = Patch(
    np.array([[1.5, 0, 0], [0, 1.5, 0], [0, 0, 1.5], [1, 1, 0.5], [1, 0.5, 1], [0.5, 1, 1]])
)


# A rotation that takes the only normal of the parabolic line away from the axes.
TURNED = np.array([[3.0, 6.0, 2.0], [-2.0, 3.0, -6.0], [-6.0, 2.0, 3.0]]) / 7


def folded(uv: Floats) -> Floats:
    """Return points of a quadratic surface with the parabolic line v = 0, which has one normal."""
    u, v = np.moveaxis(uv, -1, 0)
    return np.stack([u * u / 2 + u, u * v + v - u * u, v * v], axis=-1) @ TURNED.T


BESIDE = Patch.of(folded, np.array([[0.8, 0.0], [0.0, 1.0], [-0.5, 0.0]]))
ACROSS = Patch.of(folded, np.array([[0.8, -0.4], [0.1, 0.8], [-0.5, -0.5]]))


def figure_2() -> tuple[Figure, str]:
    """Draw a quadratic triangular Bézier patch with its control net."""
    figure, axes = panels(4.0, 3.5, 1, 1, left=0.01, right=0.99, bottom=0.01, top=0.99)
    picture = draw_patch(axes[0, 0], PATCH, view(*SIDE))
    net = PATCH.net
    picture.fit(net, 0.1)
    legs = [net[list(leg)] for leg in LEGS]
    picture.lines(legs, hide=False, colors=INK, linewidths=0.9, linestyles=(0, (4, 2)), zorder=4)
    picture.points(net, hide=False, s=18)
    for control_point, index in zip(net, INDICES, strict=True):
        text = rf"$\mathbf{{b}}_{{{index}}}$"
        gap = 14.0 if "2" in index else 21.0  # beyond the edge of the patch
        picture.label(control_point, text, net.mean(axis=0), gap, 11.0)
    return figure, (
        "A quadratic triangular Bézier patch with its control net; $`\\mathbf b_{ijk}`$ belongs to "
        "$`u^i v^j w^k`$, and the edges are u = 0 (black; white on dark pages), v = 0 (green) and "
        "w = 0 (purple). These control points have the support function (12); the printed control "
        "points (11) have another one ([errata](errata.md))."
    )


def figure_3() -> tuple[Figure, str]:
    """Draw three patches and the domains of their support functions on the sphere."""
    figure, axes = panels(
        5.6, 8.4, 3, 2, left=0.02, right=0.98, bottom=0.04, top=0.97, wspace=0.05, hspace=0.1
    )
    rows = (
        (PATCH, view(*SIDE), "An elliptic patch"),
        (BESIDE, view(), "Its edge $v = 0$ is a parabolic line"),
        (ACROSS, view(), "A parabolic line inside"),
    )
    for (left, right), (patch, seen_from, title) in zip(axes, rows, strict=True):
        draw_patch(left, patch, seen_from, title)
        draw_image(right, patch, seen_from, f"Its Gaussian image: a {patch.image.kind}")
    add_legend(figure)
    return figure, caption_3(*(patch.image for patch, *_ in rows))


def add_legend(figure: Figure) -> None:
    """Explain the colours of edges and parts."""
    edges = [Line2D([], [], color=x, linewidth=1.8, label=f"${e}$") for e, (_, x) in EDGES.items()]
    parts = [
        Rectangle((0, 0), 1, 1, color=tuple(TINTS[1 + sign]), label=name)
        for sign, name in ((1, "elliptic"), (-1, "hyperbolic"))
    ]
    figure.legend(handles=edges + parts, loc="lower center", ncols=5, frameon=False)


def caption_3(
    triangle: gm.gauss_map.GaussianImage,
    biangle: gm.gauss_map.GaussianImage,
    bow_tie: gm.gauss_map.GaussianImage,
) -> str:
    """Return the caption, with the solid angles of the images."""
    elliptic = (bow_tie.area + bow_tie.solid_angle) / 2
    hyperbolic = (bow_tie.area - bow_tie.solid_angle) / 2
    return (
        f"Patches (left) and their Gaussian images (right), the domains of their support "
        f"functions; each pair is seen from the same side. An edge and the arc to which it is "
        f"mapped have the same colour. The arcs lie on spherical conics (thin lines), in which "
        f"three quadratic cones and their opposites intersect the sphere. Top: the patch of Fig. 2 "
        f"fills a triangle of {triangle.area:.3f} sr. Middle: all points of the edge v = 0 have "
        f"the same normal, so that one side shrinks to a point and leaves a biangle of "
        f"{biangle.area:.3f} sr. Bottom: the parabolic line of the same surface cuts this patch "
        f"into an elliptic and a hyperbolic part, which fill the two wings of a bow tie, "
        f"{elliptic:.3f} sr and {hyperbolic:.3f} sr."
    )


def draw_patch(axes: Axes, patch: Patch, view: Floats, title: str = "") -> Picture:
    """Draw a patch with parameter lines and edges."""
    picture = Picture(axes, Scene(quadrangles(bezier(patch.net, patch.mesh)), view=view), title)
    picture.surface(patch.tints)
    lines = [bezier(patch.net, x) for x in isolines(8)]
    picture.lines(lines, hide=False, colors="white", linewidths=0.6, zorder=2)
    t = np.linspace(0.0, 1.0, 65)[:, None]
    for places, colour in EDGES.values():
        edge = conic(patch.net[list(places)], 1 - t, t)
        picture.lines([edge], hide=False, colors=colour, linewidths=1.8, zorder=3)
    return picture


def draw_image(axes: Axes, patch: Patch, view: Floats, title: str) -> None:
    """Draw the Gaussian image, its boundary arcs, and thin lines for the cones of these arcs."""
    normals = unit(bezier(patch.control_normals, patch.mesh))
    globe = Globe(axes, view, title)
    globe.region(quadrangles(normals), patch.tints)
    angle = np.linspace(0.0, np.pi, 2001)[:, None]
    for arc, (_, colour) in zip(patch.image.arcs, EDGES.values(), strict=True):
        whole = unit(conic(arc.control_normals, np.cos(angle), np.sin(angle)))
        globe.lines([whole, -whole], colors=colour, linewidths=0.6, alpha=0.6, zorder=4)
        globe.lines([arc.points(1001)], colors=colour, linewidths=1.8)


def conic(points: Floats, s: Floats, t: Floats) -> Floats:
    """Return s² b₀ + 2 s t b₁ + t² b₂: with s, t ≥ 0 the arc, else the rest of the conic."""
    return s * s * points[0] + 2 * s * t * points[1] + t * t * points[2]


def isolines(count: int) -> list[Floats]:
    """Return lines u, v, w = constant of a triangle in barycentric coordinates."""
    lines = []
    for c in np.arange(1, count) / count:
        t = np.linspace(0.0, 1.0 - c, 49)
        line = (np.full_like(t, c), t, 1.0 - c - t)
        lines += [np.stack((*line[k:], *line[:k]), axis=-1) for k in range(3)]
    return lines
