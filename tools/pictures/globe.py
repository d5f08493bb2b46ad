"""The unit sphere in a picture: a translucent globe, and the direction of view."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .palette import GLOBE, INK, PALE
from .scene import view

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_globe", "view_of"]


def draw_globe(axes: Axes, view: NDArray[np.float64]) -> None:
    """Draw a translucent globe with meridians and parallels every 30°, and the three axes."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Circle
    from matplotlib.patheffects import withStroke

    axes.add_patch(Circle((0, 0), 1.0, facecolor=GLOBE, alpha=0.75, linewidth=0, zorder=2))
    turn = np.linspace(0.0, 2 * math.pi, 181)
    c, s, ones = np.cos(turn), np.sin(turn), np.ones_like(turn)
    circles = [
        np.outer(c, [math.cos(a), math.sin(a), 0.0]) + np.outer(s, [0.0, 0.0, 1.0])
        for a in np.radians(range(0, 180, 30))
    ] + [
        np.stack([math.cos(a) * c, math.cos(a) * s, math.sin(a) * ones], axis=1)
        for a in np.radians(range(-60, 90, 30))
    ]
    seen = np.array(circles) @ view.T
    pieces = np.stack([seen[:, :-1], seen[:, 1:]], axis=2).reshape(-1, 2, 3)
    front = pieces[(pieces[..., 2] >= 0.0).all(axis=1)][..., :2]
    axes.add_collection(LineCollection(list(front), colors="white", linewidths=0.8, zorder=3))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=PALE, linewidth=0.6, zorder=4))
    halo = [withStroke(linewidth=2.0, foreground="white")]
    for direction, name in zip(view.T, "xyz", strict=True):
        across = float(np.linalg.norm(direction[:2]))
        if direction[2] < -0.3:  # behind the globe
            continue
        reach = 1.1 / across if across > 0.75 else 1.15
        axes.plot(*np.outer(direction[:2], [1.0, reach]), color=INK, linewidth=0.7, zorder=5)
        x, y, _ = direction * (reach + 0.1)
        axes.text(x, y, name, ha="center", va="center", path_effects=halo, zorder=7)


def view_of(
    normals: NDArray[np.float64], old: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the rows (3, 3) right, up, and towards a viewer who sees most of the normals.

    That is the viewer `old`, by default of `view()`, turned towards the mean normal, the further
    the more the normals are concentrated.
    """
    old = view() if old is None else old
    mean = normals.mean(axis=0)
    new = (1.0 - np.linalg.norm(mean)) * old[2] + mean
    length = float(np.linalg.norm(new))
    cosine = float(old[2] @ new) / length if length > 1e-6 else -1.0
    if cosine < -0.999:  # straight from behind
        return old * [[-1.0], [1.0], [-1.0]]
    new /= length
    turned = old[:2] - np.outer(old[:2] @ new / (1.0 + cosine), old[2] + new)
    return np.vstack([turned, new])
