"""The patch that osculates a surface at a point, from its 2-jet: normals, curvatures and forms."""

from __future__ import annotations

import math

from ....generated.jet import at_jet, forms_at_jet
from ....generated.vectors import Patch, Vector
from ...base.tolerances import VANISHING
from ...directions.kernels.vectors import dot, set_row
from ...machine_code.jit import inline, jit


@inline
def jet_vector(jets, k, i, factor):
    """Return a vector of a 2-jet, times a factor."""
    return Vector(factor * jets[k, i, 0], factor * jets[k, i, 1], factor * jets[k, i, 2])


@inline
def patch_of_jet(jets, k, size, du, dv):
    """Return the patch that osculates `size` times the surface; cells du × dv become 1 × 1."""
    along_u = size * du
    along_v = size * dv
    return Patch(
        jet_vector(jets, k, 3, along_u * du),
        jet_vector(jets, k, 4, along_u * dv),
        jet_vector(jets, k, 5, along_v * dv),
        jet_vector(jets, k, 1, along_u),
        jet_vector(jets, k, 2, along_v),
        jet_vector(jets, k, 0, size),
    )


@inline
def is_regular(patch, L, K):
    """Return whether a patch is regular at its point u = v = 0.

    At this point, L is the length of the normal, and K the Gaussian curvature.
    """
    largest = max(dot(patch.d, patch.d), dot(patch.e, patch.e))
    return VANISHING * largest < L and abs(K) < math.inf


@jit
def evaluate_jets(jets, scales, normals, gaussian, mean):
    """Write unit normals (k, 3), K (k,) and H (k,) from 2-jets (k, 6, 3); 0 at singular points.

    `scales` = (size, du, dv): `size` times the surface has cells du × dv of about the size 1.
    """
    size, du, dv = scales
    for k in range(jets.shape[0]):
        patch = patch_of_jet(jets, k, size, du, dv)
        L, n, K, H = at_jet(patch)
        regular = is_regular(patch, L, K)
        set_row(normals, k, n if regular else Vector(0.0, 0.0, 0.0))
        gaussian[k] = K * size * size if regular else 0.0
        mean[k] = H * size if regular else 0.0


@jit
def forms_of_jets(jets, scales, forms):
    """Write E, F, G, e, f, g and D (k, 7) of 2-jets (k, 6, 3), see `forms_at_jet`.

    The forms are those of `size` times the surface, with u and v in units of cells; `scales` =
    (size, du, dv). The third form and the sign of K are 0 at singular points.
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
