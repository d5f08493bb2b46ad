"""The middle of a picture: the support function, as colours on a unit sphere for each branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.samples.samples import Samples
from .colours import Colours
from .marked import Marked
from .palette import INK, MARK
from .sphere_half import draw_globe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOM = 1.13  # half of the side of the axes; the globe has the radius 1
PIXELS = 256  # along the diameter of the globe
FAR = 1.5  # beyond this, relative to the distance between normals, a branch is not drawn
BEHIND = {"facecolor": "white", "edgecolor": "none", "pad": 1.2, "alpha": 0.85}  # behind a text


class Branch(NamedTuple):
    """A branch of the support function: a mask (N,) of its samples, and its name."""

    name: str
    samples: NDArray[np.bool_]


def branches_of(samples: Samples) -> list[Branch]:
    """Return the branches of the support function at prescribed normals, if there are at most two.

    The branches are the elliptic and the hyperbolic samples: each normal has at most one of each.
    """
    if "support" not in samples.fields:
        return []
    index = samples.normal_index
    found = []
    for name, kind in (("K > 0", samples.elliptic), ("K < 0", samples.hyperbolic)):
        chosen = kind & (index >= 0)
        if chosen.any():
            if np.bincount(index[chosen]).max() > 1:
                return []
            found.append(Branch(name, chosen))
    return found


def draw_branch(
    axes: Axes,
    samples: Samples,
    branch: Branch,
    colours: Colours,
    view: NDArray[np.float64],
    marked: Marked | None,
) -> None:
    """Draw the support function of a branch as colours on the globe, with its value at the mark."""
    from matplotlib.patches import Circle

    axes.set(xlim=(-ROOM, ROOM), ylim=(-ROOM, ROOM), aspect="equal")
    axes.set_axis_off()
    draw_globe(axes, view, labelled=False)
    normals, points = (
        x[branch.samples].astype(np.float64) for x in (samples.normals, samples.points)
    )
    axes.imshow(
        colours.scale(colours.norm(values_on_globe(normals, points, view))), zorder=2.5,
        extent=(-1.0, 1.0, -1.0, 1.0), origin="lower", interpolation="bilinear",
    ).set_clip_path(Circle((0.0, 0.0), 1.0, transform=axes.transData))  # fmt: skip
    axes.set(xlim=(-ROOM, ROOM), ylim=(-ROOM, ROOM))
    axes.text(-ROOM, 0.98, branch.name, ha="left", va="center", color=INK)
    if marked is None or not (marked.samples & branch.samples).any():
        return
    x, y, _ = view @ marked.normal
    axes.scatter(x, y, s=34, facecolors=MARK, edgecolors=INK, linewidths=0.9, zorder=8)
    value = float(samples.support[marked.samples & branch.samples][0])
    axes.annotate(
        f"$h = {value:.3g}$", (x, y), xytext=(-7, -6), textcoords="offset points",
        ha="right", va="top", zorder=9, bbox=BEHIND,
    )  # fmt: skip


def values_on_globe(
    normals: NDArray[np.float64], points: NDArray[np.float64], view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the support function h (PIXELS, PIXELS) on the front of the globe.

    It is NaN far from all normals.

    A sample with the normal m is at the point x = ∇h(m). So h(n) is n·x, with x for the m nearest
    to n, up to an error of the order of the squared angle between n and m.
    """
    x, y = np.meshgrid(*2 * [np.linspace(-1.0, 1.0, PIXELS)])
    across = np.maximum(np.hypot(x, y), 1.0)  # pixels outside are clipped
    x, y = x / across, y / across
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    directions = np.stack([x, y, z], axis=2) @ view
    tree = tree_of(normals)
    distance, nearest = tree.query(directions)
    spacing = np.median(tree.query(normals, 2)[0][:, 1]) if len(normals) > 1 else 0.0
    values = np.einsum("ijk,ijk->ij", directions, points[nearest])
    return np.where(distance <= FAR * spacing, values, np.nan)
