"""The left of a picture: the unit sphere with the normals, a translucent globe."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from .marked import Marked
from .palette import FILLING, GLOBE, GRID, INK, MARK, NO_SAMPLE, PALE
from .scene import view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

RADIUS = 1.15  # in inches


class _Kind(NamedTuple):
    """Unit vectors that are drawn in one colour, with markers of one size.

    `area` is the area of markers relative to other kinds. `number` is the number of normals of the
    kind; equal normals are counted, but drawn once.
    """

    label: str
    number: int
    normals: NDArray[Any]
    colour: str
    area: float

    @classmethod
    def of(cls, label: str, normals: NDArray[Any], colour: str, area: float = 1.0) -> _Kind:
        return cls(label, len(normals), np.unique(np.round(normals, 4), axis=0), colour, area)


def draw_sphere(
    axes: Axes,
    samples: Samples,
    normals: NDArray[np.float64],
    view: NDArray[np.float64],
    marked: Marked | None = None,
) -> list[Line2D]:
    """Draw the unit sphere with normals into axes; return the handles of their legend.

    Prescribed normals are distinguished from those of samples that fill gaps, or are on a grid.
    """
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    view = view_of(samples.normals if len(samples) else normals, view)
    draw_globe(axes, view)
    kinds = _kinds(samples, normals)
    area = _marker_area(np.concatenate([kind.normals for kind in kinds]))
    handles = []
    for height, kind in enumerate(kinds):
        seen = kind.normals @ view.T
        front, back = seen[seen[:, 2] >= 0.0], seen[seen[:, 2] < 0.0]
        # Normals on the far side are seen through the globe.
        for some, order, size in ((front, 6, kind.area), (back, 1, 0.4 * kind.area)):
            axes.scatter(
                some[:, 0], some[:, 1], s=size * area, zorder=order + 0.1 * height,
                color=kind.colour, linewidths=0.0,
            )  # fmt: skip
        if len(seen):
            handles.append(_handle(kind.colour, f"{kind.label} ({kind.number:,})"))
    if marked is not None:
        x, y, _ = (view @ marked.normal).tolist()
        axes.annotate(
            "", (1.3 * x, 1.3 * y), (x, y), zorder=7,
            arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.0, "shrinkA": 0.0},
        )  # fmt: skip
        axes.scatter(x, y, s=34, color=MARK, edgecolors=INK, linewidths=0.9, zorder=8)
        handles.append(_handle(MARK, marked.label, INK))
    return handles


def _kinds(samples: Samples, normals: NDArray[np.float64]) -> list[_Kind]:
    """Return the normals of each kind; each prescribed normal occurs once, in one of the kinds."""
    index, kind = samples.normal_index, samples.kind
    found, first = np.unique(index[index >= 0], return_index=True)
    missed = np.ones(len(normals), dtype=bool)
    if len(normals):
        missed[found] = False
    return [
        _Kind.of("filling gaps", samples.normals[kind == "filling"], FILLING, 0.6),
        _Kind.of("on a grid", samples.normals[kind == "grid"], GRID),
        _Kind.of("prescribed, no sample", normals[missed], NO_SAMPLE),
        _Kind.of("prescribed", samples.normals[index >= 0][first], INK),
    ]


def _handle(colour: str, label: str, edge: str = "none") -> Line2D:
    """Return a handle of a legend: a disc and a label."""
    from matplotlib.lines import Line2D

    return Line2D(
        [], [], marker="o", markersize=4.5, linestyle="", markerfacecolor=colour,
        markeredgecolor=edge, label=label,
    )  # fmt: skip


def _marker_area(normals: NDArray[Any]) -> float:
    """Return the area of markers that do not overlap on the sphere, in typographic points²."""
    mean = normals.mean(axis=0)
    length = float(np.linalg.norm(mean))
    depth = 1.0 - float((normals @ mean).min()) / length if length > 1e-3 else 2.0
    room = 2 * math.pi * max(depth, 0.01) * (72 * RADIUS) ** 2
    return float(np.clip(0.09 * room / len(normals), 0.6, 8.0))


def draw_globe(axes: Axes, view: NDArray[np.float64], labelled: bool = True) -> None:
    """Draw a translucent globe with lines every 30° and, if `labelled`, with the axes x, y, z."""
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
    for direction, name in zip(view.T, "xyz" if labelled else "", strict=labelled):
        across = float(np.linalg.norm(direction[:2]))
        if direction[2] < -0.3:  # behind the globe
            continue
        reach = 1.1 / across if across > 0.75 else 1.15
        axes.plot(*np.outer(direction[:2], [1.0, reach]), color=INK, linewidth=0.7, zorder=5)
        x, y, _ = direction * (reach + 0.1)
        axes.text(x, y, name, ha="center", va="center", path_effects=halo, zorder=7)


def view_of(
    normals: NDArray[np.floating], old: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the directions right, up and towards the viewer (3, 3) of a view of the normals.

    The view `old`, by default that of `view()`, is turned towards the mean normal: not at all if
    the normals are evenly spread, fully if all of them are equal.
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
