"""The numbers of patches: four for each cell, row by row."""

from __future__ import annotations

from ...machine_code.jit import inline

__all__ = ["place_of"]


@inline
def place_of(patch, columns):
    """Return the row and the column of the cell of a patch, and its number of quarter turns."""
    cell = patch // 4
    return cell // columns, cell % columns, patch % 4
