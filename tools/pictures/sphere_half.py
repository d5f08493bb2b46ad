"""The right half of a picture: the unit sphere with the normals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from .globe import draw_globe, view_of
from .layout import RADIUS
from .palette import ELLIPTIC, HYPERBOLIC, NO_SAMPLE, PARABOLIC

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

__all__ = ["draw_sphere"]


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
