"""The picture of the search: images of patches, a cone, a bin with its pieces, and a tile."""

from __future__ import annotations

import gaussmap as gm
import numpy as np
from gaussmap.docs.drawing import HALO, Floats, Globe, panels
from gaussmap.docs.patch_figures import Patch, bezier, unit
from gaussmap.runtime.search.kernels.lists import FINEST, order_normals, write_caps
from gaussmap.runtime.search.patch_index import Index, index_of
from gaussmap.runtime.search.search import find
from gaussmap.tools.pictures.palette import GRID, HYPERBOLIC, INK, PALE
from gaussmap.tools.pictures.scene import quadrangles, view
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

CELLS = (10, 8)
NORMALS = 1500
# The direction of the bin.
MIDDLE = np.array([0.55, -0.3, 0.78])


def search_figure() -> Figure:
    """Draw the images of patches of a torus with a bin, and the tile of the bin."""
    spline, normals = gm.fit("torus", CELLS), gm.fibonacci(NORMALS)
    index = index_of(spline, 1)
    number = int(np.argmax(middles(index) @ MIDDLE))
    starts, members = index.lists.starts, index.lists.members
    pieces = members[starts[number] : starts[number + 1]]
    inside = np.flatnonzero(bins_of(index, normals) == number)
    hits = find(spline, normals, 1)
    found = np.isin(hits.normal_index, inside)
    chosen = int(np.bincount(hits.patch_index[found]).argmax())
    own = hits.normal_index[found & (hits.patch_index == chosen)]
    figure, axes = panels(7.4, 3.9, 1, 2, left=0.01, right=0.99, bottom=0.1, top=0.93, wspace=0.02)
    x, y, z = middles(index)[number]
    shown = view(np.degrees(np.arcsin(z)), np.degrees(np.arctan2(y, x)))
    whole = Globe(axes[0, 0], shown, "Images of patches, a cone, and a bin")
    near = Globe(axes[0, 1], shown, "The tile of the bin")
    for globe, width in ((whole, 0.25), (near, 0.8)):
        draw(globe, spline, index, number, pieces, chosen, width)
    others = np.setdiff1d(np.arange(len(normals)), inside)
    whole.points(normals[others], behind=0.0, s=0.8, color=PALE)
    whole.points(normals[inside], behind=0.0, s=2.0)
    near.points(normals[others], behind=0.0, s=8.0, color=PALE)
    near.points(normals[np.setdiff1d(inside, own)], behind=0.0, s=26.0, color=INK)
    near.points(normals[own], behind=0.0, s=40.0, color=GRID)
    zoom(near.axes, edge_of(index, number) @ shown.T)
    label = f"{len(pieces)} of {spline.patches} patches, {len(inside)} of {NORMALS} normals"
    at = near.axes.transAxes
    near.axes.text(0.02, 0.02, label, transform=at, path_effects=HALO, zorder=9)
    add_legend(figure)
    return figure


def middles(index: Index) -> Floats:
    """Return the centres (bins, 3) of the bins."""
    lists = index.lists
    caps = np.empty((lists.faces << 2 * lists.level, 4))
    write_caps(lists.inverse, lists.faces, lists.level, caps)
    return caps[:, :3]


def bins_of(index: Index, normals: Floats) -> np.ndarray:
    """Return the bins of normals."""
    keys = np.empty(len(normals), np.int64)
    order_normals(normals, index.lists.frame, index.lists.faces, 0, len(normals), keys)
    return keys >> 32 + 2 * (int(FINEST) - index.lists.level)


def edge_of(index: Index, number: int) -> Floats:
    """Return points (k, 3) of the boundary of a bin, on the sphere."""
    level = index.lists.level
    face, place = number >> 2 * level, number & (1 << 2 * level) - 1
    row, column = (sum((place >> 2 * k + shift & 1) << k for k in range(level)) for shift in (1, 0))
    half, t = 0.5**level, np.linspace(-1.0, 1.0, 33)
    ends = np.full_like(t, 1.0)
    s = np.concatenate([t, ends, -t, -ends])
    r = np.concatenate([-ends, t, ends, -t])
    corner = np.zeros((len(s), 3))
    axis = face >> 1
    corner[:, axis] = 1.0 if face & 1 == 0 else -1.0
    corner[:, (axis + 1) % 3] = (2 * column + 1 + s) * half - 1.0
    corner[:, (axis + 2) % 3] = (2 * row + 1 + r) * half - 1.0
    return unit(corner)


def draw(
    globe: Globe, spline: gm.Spline, index: Index, number: int, pieces: np.ndarray, chosen: int,
    width: float,
) -> None:  # fmt: skip
    """Draw all images, filled for the pieces of the bin, the bin, and the cone of one piece."""
    for k in range(spline.patches):
        patch = Patch(spline.control_nets[k])
        arcs = [arc.points(17) for arc in patch.image.arcs]
        shown = [arc for arc in arcs if arc.mean(axis=0) @ globe.view[2] > 0.0]
        globe.lines(shown, behind=0.0, colors=PALE, linewidths=width, zorder=4)
        if k in pieces:
            normals = unit(bezier(patch.control_normals, patch.mesh))
            colour = patch.tints if k != chosen else 0.85 * patch.tints
            globe.region(quadrangles(normals), np.broadcast_to(colour, (len(patch.tints), 3)))
    globe.lines([edge_of(index, number)], behind=0.0, colors=INK, linewidths=1.4, zorder=6)
    x, y, z, chord = index.pieces.cones[chosen, :4]
    axis = np.array([x, y, z])
    across = unit(np.cross(axis, [0.3, 0.5, -0.8]))
    angle = 2.0 * np.arcsin(0.5 * chord)
    turn = np.linspace(0.0, 2.0 * np.pi, 129)[:, None]
    circle = np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    cone = np.cos(angle) * axis + np.sin(angle) * circle
    globe.lines([cone], behind=0.0, colors=HYPERBOLIC, linewidths=1.4, zorder=6)


def zoom(axes: Axes, seen: Floats) -> None:
    """Show a bin and a little around it."""
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    middle, half = (low + high) / 2, 0.62 * float((high - low).max())
    axes.set(xlim=middle[0] + [-half, half], ylim=middle[1] + [-half, half])


def add_legend(figure: Figure) -> None:
    """Explain lines and points."""
    line, point = {"linewidth": 1.4}, {"marker": "o", "linestyle": "", "markersize": 5}
    looks = {
        "images of patches": {"color": PALE, "linewidth": 0.8},
        "a bin": {"color": INK, **line},
        "the cone of the dark image": {"color": HYPERBOLIC, **line},
        "its normals": {"color": GRID, **point},
        "others of the tile": {"color": INK, **point},
    }
    handles = [Line2D([], [], label=label, **look) for label, look in looks.items()]
    figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False)
