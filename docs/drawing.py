"""The elements of figures: surfaces, points, lines and normals, projected to Matplotlib's plane."""

from __future__ import annotations

from typing import Any

import numpy as np
from gaussmap.tools.pictures.palette import INK
from gaussmap.tools.pictures.scene import Scene
from gaussmap.tools.pictures.sphere_half import draw_globe
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MESH = 96  # quadrangles along each side of a surface
# Faint colours of hyperbolic, parabolic and elliptic parts.
TINTS = np.array([[0.98, 0.87, 0.76], [0.95, 0.95, 0.95], [0.80, 0.89, 0.95]])
HALO = [withStroke(linewidth=2.0, foreground="white")]  # keeps a text readable on a drawing


def panels(width: float, height: float, rows: int, columns: int, **room: Any) -> tuple[Figure, Any]:  # noqa: ANN401
    """Return a figure of a size in inches, and its axes (rows, columns), without frames."""
    figure = Figure(figsize=(width, height), dpi=200)
    axes = figure.subplots(rows, columns, squeeze=False, gridspec_kw=room)
    for panel in axes.flat:
        panel.set_axis_off()
        panel.set_aspect("equal")
    return figure, axes


class Picture:
    """A panel with a surface, and with points and lines on it."""

    def __init__(self, axes: Axes, scene: Scene, title: str = "", shape: float = 1.0) -> None:
        """Make the panel, whose height is `shape` times its width."""
        self.axes, self.scene, self.shape = axes, scene, shape
        axes.set_title(title, pad=4)
        self.fit(scene.quadrangles.reshape(-1, 3), 0.03)

    def fit(self, points: Floats, margin: float) -> None:
        """Make room for points (N, 3), with a margin relative to the extent of the panel."""
        seen = self.scene.seen(points)[:, :2]
        low, high = seen.min(axis=0), seen.max(axis=0)
        width, height = high - low
        x, y = (0.5 + margin) * max(width, height / self.shape) * np.array([1.0, self.shape])
        middle = (low + high) / 2
        self.axes.set(xlim=middle[0] + [-x, x], ylim=middle[1] + [-y, y])

    def surface(self, colours: Floats | str = "#fafcff") -> None:
        """Draw the quadrangles of the mesh from the farthest to the nearest, in light and shade."""
        scene = self.scene
        seen = scene.seen(scene.quadrangles)
        order = np.argsort(seen[..., 2].mean(axis=1))
        base = np.array(to_rgb(colours)) if isinstance(colours, str) else colours[order]
        shades = (0.7 + 0.3 * scene.brightness[order])[:, None] * base
        self.axes.add_collection(
            PolyCollection(
                list(seen[order][..., :2]), facecolors=shades, edgecolors=shades, linewidths=0.3,
                rasterized=True, zorder=1,
            )
        )  # fmt: skip

    def lines(self, lines: list[Floats], hide: bool = True, **style: Any) -> None:  # noqa: ANN401
        """Draw polylines (…, 3) on the surface, without hidden parts unless `hide` is False."""
        pieces = []
        for line in lines:
            seen = self.scene.seen(line)[:, :2]
            pairs = np.stack([seen[:-1], seen[1:]], axis=1)
            if hide:
                visible = self.scene.visible(line)
                pairs = pairs[visible[1:] & visible[:-1]]
            pieces.append(pairs)
        self.axes.add_collection(
            LineCollection(list(np.concatenate(pieces)), capstyle="round", **style)
        )

    def points(self, points: Floats, hide: bool = True, **style: Any) -> None:  # noqa: ANN401
        """Draw points (N, 3) on the surface, without hidden points unless `hide` is False."""
        shown = points[self.scene.visible(points)] if hide else points
        x, y, _ = self.scene.seen(shown).T
        self.axes.scatter(x, y, **{"color": INK, "linewidths": 0.0, "zorder": 5, **style})

    def label(self, point: Floats, text: str, away: Floats, gap: float, size: float) -> None:
        """Write a text beside a point, on the side opposite to the point `away`."""
        here, there = self.scene.seen(np.stack([point, away]))[:, :2]
        step = (here - there) / max(float(np.linalg.norm(here - there)), 1e-12)
        self.axes.annotate(
            text, here, xytext=gap * step, textcoords="offset points", ha="center", va="center",
            path_effects=HALO, zorder=8, fontsize=size,
        )  # fmt: skip


class Globe:
    """A panel with the unit sphere, and with regions, points and lines on it."""

    def __init__(self, axes: Axes, view: Floats, title: str = "") -> None:
        self.axes, self.view = axes, view
        axes.set_title(title, pad=4)
        axes.set(xlim=(-1.27, 1.27), ylim=(-1.27, 1.27))
        draw_globe(axes, view)

    def region(self, quadrangles: Floats, colours: Floats) -> None:
        """Fill small quadrangles (Q, 4, 3) of the sphere, on its front."""
        seen = quadrangles @ self.view.T
        front = (seen[..., 2] >= 0.0).all(axis=1)
        self.axes.add_collection(
            PolyCollection(
                list(seen[front][..., :2]), facecolors=colours[front], edgecolors=colours[front],
                linewidths=0.3, rasterized=True, zorder=3.5,
            )
        )  # fmt: skip

    def lines(self, lines: list[Floats], behind: float = 0.25, **style: Any) -> None:  # noqa: ANN401
        """Draw polylines (…, 3); parts behind the globe have the opacity `behind`."""
        for line in lines:
            seen = line @ self.view.T
            pairs = np.stack([seen[:-1], seen[1:]], axis=1)
            front = (pairs[..., 2] >= 0.0).all(axis=1)
            for chosen, strength in ((front, 1.0), (~front, behind)):
                self.axes.add_collection(
                    LineCollection(
                        list(pairs[chosen][..., :2]), capstyle="round",
                        **{"zorder": 5, **style, "alpha": strength * style.get("alpha", 1.0)},
                    )
                )  # fmt: skip

    def points(self, points: Floats, behind: float = 0.25, **style: Any) -> None:  # noqa: ANN401
        """Draw points (N, 3); those behind the globe have the opacity `behind`."""
        seen = points @ self.view.T
        front = seen[:, 2] >= 0.0
        for chosen, strength in ((front, 1.0), (~front, behind)):
            x, y, _ = seen[chosen].T
            look = {"color": INK, "linewidths": 0.0, "zorder": 6, **style}
            self.axes.scatter(x, y, alpha=strength, **look)
