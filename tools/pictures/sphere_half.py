"""The right half of a picture: the unit sphere with the normals, a translucent globe."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from .palette import ELLIPTIC, GLOBE, HYPERBOLIC, INK, NO_SAMPLE, PALE, PARABOLIC
from .scene import view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

__all__ = ["RADIUS", "draw_globe", "draw_sphere", "view_of"]

RADIUS = 1.35  # in inches


class _Kind(NamedTuple):
    """Normals that are drawn in the same way: in a colour, as rings or as discs."""

    label: str
    normals: NDArray[np.float64]
    colour: str
    ring: bool


def draw_sphere(
    axes: Axes, samples: Samples, normals: NDArray[np.float64], view: NDArray[np.float64]
) -> list[Line2D]:
    """Draw the unit sphere with normals into axes; return what their legend shows."""
    from matplotlib.lines import Line2D

    index, missed = samples.normal_index, np.ones(len(normals), dtype=bool)
    if len(normals):
        missed[index[index >= 0]] = False
    curved = ~samples.parabolic
    # One normal may have samples of several kinds: a disc with a ring round it.
    kinds = [
        _Kind("no sample", normals[missed], NO_SAMPLE, False),
        _Kind("elliptic", samples.normals[samples.elliptic & curved], ELLIPTIC, True),
        _Kind("hyperbolic", samples.normals[samples.hyperbolic & curved], HYPERBOLIC, False),
        _Kind("parabolic", samples.normals[~curved], PARABOLIC, False),
    ]
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    view = view_of(samples.normals if len(samples) else normals, view)
    draw_globe(axes, view)
    area = _marker_area(normals if len(normals) else samples.normals)
    handles = []
    for height, kind in enumerate(kinds):
        size = area * (2.4 if kind.ring else 1.0)
        line = min(0.6, 0.3 * math.sqrt(size)) if kind.ring else 0.0
        face = "none" if kind.ring else kind.colour
        seen = np.unique(kind.normals, axis=0) @ view.T
        front, back = seen[seen[:, 2] >= 0.0], seen[seen[:, 2] < 0.0]
        axes.scatter(
            front[:, 0], front[:, 1], s=size, zorder=6 + 0.1 * height,
            facecolors=face, edgecolors=kind.colour, linewidths=line,
        )  # fmt: skip
        # Normals on the far side are seen through the globe.
        axes.scatter(
            back[:, 0], back[:, 1], s=0.7 * area, zorder=1 + 0.1 * height,
            color=kind.colour, linewidths=0.0,
        )  # fmt: skip
        if len(kind.normals):
            handles.append(
                Line2D(
                    [], [], marker="o", markersize=5.0 if kind.ring else 3.5, linestyle="",
                    markeredgecolor=kind.colour, markerfacecolor=face,
                    label=f"{kind.label} ({len(kind.normals):,})",
                )
            )  # fmt: skip
    return [*handles[1:], handles[0]] if missed.any() else handles


def _marker_area(normals: NDArray[np.float64]) -> float:
    """Return the area of a marker in points², such that markers do not overlap on the sphere."""
    mean = normals.mean(axis=0)
    length = float(np.linalg.norm(mean))
    depth = 1.0 - float((normals @ mean).min()) / length if length > 1e-3 else 2.0
    room = 2 * math.pi * max(depth, 0.01) * (72 * RADIUS) ** 2
    return float(np.clip(0.12 * room / len(normals), 0.6, 8.0))


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
