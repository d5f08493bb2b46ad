"""The fundamental forms of a surface, or of its spline, in cells of the parameters."""

from __future__ import annotations

import math

import numpy as np

from ...generated.jet import forms_at_jet
from ...generated.patch import tangents
from ...generated.spline import CORNERS
from ...generated.vectors import Patch
from .jit import inline, jit, loop
from .patch import patch_vectors
from .refine import patch_of_jet
from .spline import locate

__all__ = ["forms_of_jets", "forms_on_spline", "patches_at"]

# From steps in cells to steps in the parameters u, v of a patch, for its quarter turns.
TO_PATCH = np.linalg.inv(CORNERS)


@inline
def set_forms(forms, k, E, F, G, e, f, g, D):
    """Write row k of forms (…, 7); the third form and the sign are 0 where it is singular."""
    forms[k, 0] = E
    forms[k, 1] = F
    forms[k, 2] = G
    regular = math.isfinite(e) and math.isfinite(f) and math.isfinite(g)
    forms[k, 3] = max(e, 0.0) if regular else 0.0
    forms[k, 4] = f if regular else 0.0
    forms[k, 5] = max(g, 0.0) if regular else 0.0
    forms[k, 6] = D if regular else 0.0


@jit
def forms_of_jets(jets, scales, forms):
    """Write E, F, G, e, f, g and D (k, 7) of 2-jets (k, 6, 3), see `forms_at_jet`.

    They are those of `size` times the surface in cells; `scales` = (size, du, dv).
    """
    size, du, dv = scales
    for k in range(jets.shape[0]):
        E, F, G, e, f, g, D = forms_at_jet(patch_of_jet(jets, k, size, du, dv))
        set_forms(forms, k, E, F, G, e, f, g, D)


@loop
def forms_of_patch(patch, u, v):
    """Return the forms of a patch at u, v, in its parameters."""
    p_u, p_v, _ = tangents(patch, u, v)
    return forms_at_jet(Patch(patch.a, patch.b, patch.c, p_u, p_v, patch.p))


@inline
def in_cells(E, F, G, turn):
    """Return the form E, F, G of the parameters of a patch, for steps in cells."""
    a = TO_PATCH[turn, 0, 0]
    b = TO_PATCH[turn, 0, 1]
    c = TO_PATCH[turn, 1, 0]
    d = TO_PATCH[turn, 1, 1]
    return (
        a * a * E + 2.0 * a * b * F + b * b * G,
        a * c * E + (a * d + b * c) * F + b * d * G,
        c * c * E + 2.0 * c * d * F + d * d * G,
    )


@jit
def forms_on_spline(mu, scale, cells, forms):
    """Write what `forms_of_jets` writes, of a spline at places (k, 2) in cells."""
    for k in range(cells.shape[0]):
        i = min(max(int(math.floor(cells[k, 0])), 0), mu.shape[0] - 3)
        j = min(max(int(math.floor(cells[k, 1])), 0), mu.shape[1] - 3)
        turn, u, v = locate(cells[k, 0] - i - 0.5, cells[k, 1] - j - 0.5)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        E, F, G, e, f, g, D = forms_of_patch(patch, u, v)
        E, F, G = in_cells(E, F, G, turn)
        e, f, g = in_cells(e, f, g, turn)
        set_forms(forms, k, E, F, G, e, f, g, D)


@jit
def patches_at(rows, columns, cells, patches, places):
    """Write the patches (k,) and their parameters (k, 2) at places (k, 2) in cells.

    `rows` and `columns` are the numbers of cells along u and v.
    """
    for k in range(cells.shape[0]):
        i = min(max(int(math.floor(cells[k, 0])), 0), rows - 1)
        j = min(max(int(math.floor(cells[k, 1])), 0), columns - 1)
        turn, u, v = locate(cells[k, 0] - i - 0.5, cells[k, 1] - j - 0.5)
        patches[k] = 4 * (i * columns + j) + turn
        places[k, 0] = u
        places[k, 1] = v
