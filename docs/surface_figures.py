"""Figs. 6 and 7: samplings of a part of an ellipsoid and of a surface that is not convex."""

from __future__ import annotations

from collections.abc import Sequence

import gaussmap as gm
import numpy as np
from gaussmap.docs.drawing import MESH, TINTS, Floats, Globe, Picture, panels
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, INK, PALE
from gaussmap.tools.pictures.scene import quadrangles, scene_of, view
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

ELLIPSOID = gm.Surface.from_sympy(
    ("1.6*cos(u)*cos(v)", "1.2*sin(u)*cos(v)", "0.8*sin(v)"),
    ("u", "v"),
    domain=((-1.9, 0.4), (-0.5, 1.25)),
    name="part of an ellipsoid",
)


def figure_6() -> tuple[Figure, str]:
    """Draw a part of an ellipsoid, two samplings of it, and their normals."""
    figure, axes = panels(
        7.4, 4.7, 2, 3, left=0.01, right=0.99, bottom=0.0, top=0.945, wspace=0.02, hspace=0.12,
        height_ratios=(0.75, 1.0),
    )  # fmt: skip
    spline = gm.fit(ELLIPSOID)
    counts = []
    eye = view(35.0, -50.0)
    surface_picture(axes[0, 0], spline, eye, "A part of an ellipsoid", 0.75)
    image_of(axes[1, 0], spline, eye, "Its Gaussian image")
    for k, frequency in enumerate((10, 20), start=1):
        normals = gm.icosphere(frequency)
        samples = gm.sample(spline, normals=normals)
        picture = surface_picture(axes[0, k], spline, eye, f"{len(samples):,} samples", 0.75)
        size = 10.0 / k**1.5
        picture.points(samples.points, s=size, color=ELLIPTIC)
        globe = image_of(axes[1, k], spline, eye, f"{len(normals):,} uniform normals")
        missed = np.delete(normals, samples.normal_index, axis=0)
        globe.points(missed, behind=0.0, s=0.6 * size, color=PALE)
        globe.points(samples.normals, behind=0.0, s=size, color=ELLIPTIC)
        counts.append((len(samples), len(normals)))
    return figure, caption_6(spline, counts)


def caption_6(spline: gm.Spline, counts: Sequence[tuple[int, int]]) -> str:
    """Return the caption of Fig. 6, with the numbers of normals in the image."""
    share = spline.measure[1].sum() / (4 * np.pi)
    found = [f"{x:,} of {y:,} normals ({100 * x / y:.2f} %)" for x, y in counts]
    return (
        f"A part of an ellipsoid, its Gaussian image, and two samplings; surface and sphere are "
        f"seen from the same side. The image covers {100 * share:.2f} % of the sphere. Of uniform "
        f"normals, those of two refinements of an icosahedron, {found[0]} and {found[1]} lie in it "
        f"(blue, others grey), and each gives one sample."
    )


def figure_7() -> tuple[Figure, str]:
    """Draw a surface that is not convex, the spline, a sampling and its normals."""
    figure, axes = panels(7.4, 2.8, 1, 3, left=0.01, right=0.99, bottom=0.07, top=0.91, wspace=0.02)
    spline = gm.fit(gm.surfaces.wavy_graph(amplitude=0.35), cells=(16, 16))
    eye = view(42.0, -65.0)
    picture = surface_picture(axes[0, 0], spline, eye, "The approximating spline", lines=False)
    picture.lines(crisscross(spline), colors=INK, linewidths=0.3, zorder=3)
    normals = gm.icosphere(12)
    samples = gm.sample(spline, normals=normals)
    picture = surface_picture(axes[0, 1], spline, eye, f"{len(samples):,} samples", lines=False)
    globe = image_of(axes[0, 2], spline, view(62.0, -65.0), "Their normals")
    for kind, colour in (("elliptic", ELLIPTIC), ("hyperbolic", HYPERBOLIC)):
        chosen = samples[getattr(samples, kind)]
        picture.points(chosen.points, s=4.0, color=colour, label=kind)
        globe.points(chosen.normals, s=14.0 if kind == "elliptic" else 4.0, color=colour)
    figure.legend(
        *picture.axes.get_legend_handles_labels(), loc="lower center", ncols=2, frameon=False,
        markerscale=2.0,
    )  # fmt: skip
    return figure, caption_7(spline, samples)


def caption_7(spline: gm.Spline, samples: gm.Samples) -> str:
    """Return the caption of Fig. 7, with the numbers of samples that a normal has."""
    m, n = spline.cells
    found = np.unique(samples.normal_index)
    elliptic, hyperbolic = (
        np.bincount(samples.normal_index[x])[found] for x in (samples.elliptic, samples.hyperbolic)
    )
    return (
        f"A surface that is not convex. Left: the spline that approximates it, {m} × {n} cells of "
        f"four quadratic triangles. Centre: {len(samples):,} samples, {samples.elliptic.sum():,} "
        f"elliptic and {samples.hyperbolic.sum():,} hyperbolic. Right: their normals on the "
        f"sphere, {len(found):,} of the {samples.report.normals:,} of a refined icosahedron, seen "
        f"from higher. The image covers itself: each of these normals has {spread(elliptic)} "
        f"elliptic and {spread(hyperbolic)} hyperbolic points."
    )


def spread(counts: NDArray[np.int64]) -> str:
    """Return the smallest and the largest of some numbers."""
    low, high = counts.min(), counts.max()
    return f"{low}" if low == high else f"{low} to {high}"


def surface_picture(
    axes: Axes, spline: gm.Spline, eye: Floats, title: str, shape: float = 1.0,
    lines: bool = True,
) -> Picture:  # fmt: skip
    """Draw a spline with some parameter lines."""
    scene = scene_of(spline, eye)
    picture = Picture(axes, scene, title, shape)
    picture.surface("#dbe9f3")
    if lines:
        picture.lines(list(scene.lines), colors="white", linewidths=0.6, zorder=2)
    return picture


def image_of(axes: Axes, spline: gm.Spline, eye: Floats, title: str) -> Globe:
    """Draw the Gaussian image of a spline."""
    (u0, u1), (v0, v1) = spline.domain
    u, v = np.linspace(u0, u1, MESH + 1)[:, None], np.linspace(v0, v1, MESH + 1)
    normals = spline.normals(u, v)
    globe = Globe(axes, eye, title)
    quads = quadrangles(normals)
    globe.region(quads, np.tile(TINTS[2], (len(quads), 1)))
    return globe


def crisscross(spline: gm.Spline) -> list[Floats]:
    """Return the edges of the triangles of a spline."""
    (u0, u1), (v0, v1) = spline.domain
    m, n = spline.cells
    t = np.linspace(0.0, 1.0, 8 * max(m, n) + 1)
    lines = [(np.full_like(t, k / m), t) for k in range(m + 1)]
    lines += [(t, np.full_like(t, k / n)) for k in range(n + 1)]
    for k in range(-m + 1, n):  # diagonals of square cells
        line = t[(t + k / n >= 0) & (t + k / n <= 1)]
        lines += [(line, line + k / n), (line, 1 - line - k / n)]
    return [spline.evaluate(u0 + (u1 - u0) * s, v0 + (v1 - v0) * r) for s, r in lines]
