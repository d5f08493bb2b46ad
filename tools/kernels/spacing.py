"""Spacings of points on the border of a mesh."""

from __future__ import annotations

from ...generated.mesh import border_spacing
from ...runtime.kernels.jit import jit

__all__ = ["border_spacings"]


@jit
def border_spacings(distances, k, spacings):
    """Write the spacing of border points (n,) whose k-th nearest samples have these distances."""
    for i in range(distances.size):
        spacings[i] = border_spacing(distances[i], k)
