"""The fundamental forms of a surface in cells of the parameters, and the 2-jets of its spline."""

from __future__ import annotations

import math

import numpy as np

from ....generated.jet import forms_at_jet
from ....generated.patch import envelope, tangents
from ....generated.spline import CORNERS, SCALE
from ...machine_code.jit import inline, jit
from .jets import patch_of_jet
from .patch import patch_vectors, vector_at
from .spline import patch_at

__all__ = ["forms_of_jets", "jets_on_spline", "patches_at"]

# From steps in cells to steps in the parameters u, v of a patch, for its quarter turns.
TO_PATCH = np.linalg.inv(CORNERS)


@jit
def forms_of_jets(jets, scales, forms):
    """Write E, F, G, e, f, g and D (k, 7) of 2-jets (k, 6, 3), see `forms_at_jet`.

    The forms are those of `size` times the surface, by u and v in cells; `scales` = (size, du, dv).
    The third form and the sign of K are 0 at singular points.
    """
    size, du, dv = scales
    for k in range(jets.shape[0]):
        E, F, G, e, f, g, D = forms_at_jet(patch_of_jet(jets, k, size, du, dv))
        regular = math.isfinite(e) and math.isfinite(f) and math.isfinite(g)
        forms[k, 0] = E
        forms[k, 1] = F
        forms[k, 2] = G
        forms[k, 3] = max(e, 0.0) if regular else 0.0
        forms[k, 4] = f if regular else 0.0
        forms[k, 5] = max(g, 0.0) if regular else 0.0
        forms[k, 6] = D if regular else 0.0


@inline
def set_combination(jets, k, row, v, w, a, b):
    """Write the vector a v + b w into a 2-jet."""
    jets[k, row, 0] = a * v.x + b * w.x
    jets[k, row, 1] = a * v.y + b * w.y
    jets[k, row, 2] = a * v.z + b * w.z


@inline
def set_second(jets, k, row, patch, uu, uv, vv, size):
    """Write a second derivative: a combination of those of a patch, divided by `size`."""
    set_combination(jets, k, row, patch.a, patch.c, uu / size, vv / size)
    jets[k, row, 0] += uv / size * patch.b.x
    jets[k, row, 1] += uv / size * patch.b.y
    jets[k, row, 2] += uv / size * patch.b.z


@jit
def jets_on_spline(mu, scale, frame, cells, jets):
    """Write the 2-jets (k, 6, 3) of a spline at parameters (k, 2) in cells.

    Second derivatives are those of one of the patches that meet at a point.
    """
    size = SCALE * scale
    du = frame[2]
    dv = frame[3]
    for k in range(cells.shape[0]):
        i, j, turn, u, v = patch_at(cells[k, 0], cells[k, 1], mu.shape[0] - 2, mu.shape[1] - 2)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        x = envelope(patch, u, v)
        p_u, p_v, _ = tangents(patch, u, v)
        # Derivatives along the lines of the parameters, from those along the sides of the patch.
        a = TO_PATCH[turn, 0, 0] / du
        b = TO_PATCH[turn, 0, 1] / du
        c = TO_PATCH[turn, 1, 0] / dv
        d = TO_PATCH[turn, 1, 1] / dv
        set_combination(jets, k, 0, x, vector_at(mu, i + 1, j + 1), 1.0 / size, 1.0)
        set_combination(jets, k, 1, p_u, p_v, a / size, b / size)
        set_combination(jets, k, 2, p_u, p_v, c / size, d / size)
        set_second(jets, k, 3, patch, a * a, 2.0 * a * b, b * b, size)
        set_second(jets, k, 4, patch, a * c, a * d + b * c, b * d, size)
        set_second(jets, k, 5, patch, c * c, 2.0 * c * d, d * d, size)


@jit
def patches_at(rows, columns, cells, patches, places):
    """Write the patches (k,) and the parameters (k, 2) in these for parameters (k, 2) in cells.

    `rows` and `columns` are the numbers of cells along u and v.
    """
    for k in range(cells.shape[0]):
        i, j, turn, u, v = patch_at(cells[k, 0], cells[k, 1], rows, columns)
        patches[k] = 4 * (i * columns + j) + turn
        places[k, 0] = u
        places[k, 1] = v
