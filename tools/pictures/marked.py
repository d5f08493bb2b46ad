"""The normal that a picture marks in all its panels, with its samples."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples

# A direction, by components right, up and towards the viewer, such that an arrow along it is not
# seen end on.
BETWEEN = np.array([0.6, 0.35, 0.8])


class Marked(NamedTuple):
    """A prescribed normal (3,), its samples, and a mask (N,) of the visible ones."""

    normal: NDArray[np.float64]
    samples: NDArray[np.bool_]
    visible: NDArray[np.bool_]

    @property
    def label(self) -> str:
        """The text of the legend."""
        count, seen = (int(np.count_nonzero(x)) for x in (self.samples, self.visible))
        points = "one normal and its point" + ("" if count == 1 else f"s ({count:,}")
        return points if count == 1 else points + (")" if seen == count else f", {seen:,} visible)")


def marked(
    samples: Samples, visible: NDArray[np.bool_], view: NDArray[np.float64]
) -> Marked | None:
    """Return a normal with many visible samples, or None if no visible sample is at a normal.

    Among the normals with at least the mean number of visible samples, the normal nearest to the
    direction BETWEEN is chosen. The rows of `view` are the directions right, up, and towards the
    viewer.
    """
    index = samples.normal_index
    chosen = visible & (index >= 0)
    if not chosen.any():
        return None
    shown = np.bincount(index[chosen])
    mean = np.count_nonzero(chosen) / len(np.unique(index[index >= 0]))
    rows = np.flatnonzero(chosen)
    rows = rows[shown[index[rows]] >= mean]
    row = rows[np.argmax(samples.normals[rows] @ (BETWEEN @ view))]
    same = index == index[row]
    return Marked(samples.normals[row].astype(np.float64), same, same & visible)
