"""Faces of CAD parts: derivatives of surfaces of revolution and of offsets."""

from __future__ import annotations

import math

from ....generated.faces import offset_jet, revolution_jet
from ....generated.jet import at_jet
from ....generated.vectors import Patch
from ....runtime.directions.kernels.vectors import row_vector, set_jet
from ....runtime.machine_code.jit import jit

__all__ = ["offset", "revolve"]


@jit
def revolve(u, curve, out):
    """Write x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) of curves turned about the z axis by u (k,).

    The curve is given by its points and its first and second derivatives (k, 3, 3).
    """
    for k in range(len(u)):
        p, x_u, x_v, x_uu, x_uv, x_vv = revolution_jet(
            row_vector(curve[k], 0), row_vector(curve[k], 1), row_vector(curve[k], 2),
            math.cos(u[k]), math.sin(u[k]),
        )  # fmt: skip
        set_jet(out[k], p, x_u, x_v, x_uu, x_uv, x_vv)


@jit
def offset(distance, jets, thirds, out):
    """Write y, y_u, y_v, y_uu, y_uv, y_vv (k, 6, 3) at a distance from 2-jets (k, 6, 3).

    Second derivatives need third ones of x (k, 4, 3): x_uuu, x_uuv, x_uvv, x_vvv. All are NaN where
    x_u × x_v = 0.
    """
    for k in range(len(jets)):
        patch = Patch(
            row_vector(jets[k], 3), row_vector(jets[k], 4), row_vector(jets[k], 5),
            row_vector(jets[k], 1), row_vector(jets[k], 2), row_vector(jets[k], 0),
        )  # fmt: skip
        L, n, _, _ = at_jet(patch)
        p, x_u, x_v, x_uu, x_uv, x_vv = offset_jet(
            patch, row_vector(thirds[k], 0), row_vector(thirds[k], 1), row_vector(thirds[k], 2),
            row_vector(thirds[k], 3), n, L, distance,
        )  # fmt: skip
        set_jet(out[k], p, x_u, x_v, x_uu, x_uv, x_vv)
