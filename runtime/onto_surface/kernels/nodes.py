"""Solid angles of the normals of a surface, from its 2-jets at Gauss points of cells."""

from __future__ import annotations

import math

from ....generated.jet import at_jet
from ...base.tolerances import VANISHING
from ...directions.kernels.vectors import dot
from ...machine_code.jit import jit
from ...spline.kernels.jets import patch_of_jet

# The Gauss points of a cell are at 1/2 ± GAUSS/2 of its sides.
GAUSS = 1.0 / math.sqrt(3.0)


@jit
def signed_solid_angles(jets, size, frame, found):
    """Write K times the area element at points with the 2-jets (k, 6, 3); 0 at singular points.

    Area elements are for the parameters in units of cells; lengths are multiplied by `size`.
    """
    for k in range(jets.shape[0]):
        patch = patch_of_jet(jets, k, size, frame[2], frame[3])
        area, _, K, _ = at_jet(patch)
        scale = math.sqrt(dot(patch.d, patch.d) * dot(patch.e, patch.e))
        found[k] = K * area if area > VANISHING * scale and abs(K) < math.inf else 0.0
