"""The indices of patches: four for each cell, cell by cell along v."""

from __future__ import annotations

from ...machine_code.jit import inline


@inline
def place_of(patch, columns):
    """Return row and column of the cell of a patch, and the quarter turns (0 to 3) of the patch."""
    cell = patch // 4
    return cell // columns, cell % columns, patch % 4
