"""Faces of CAD parts: derivatives of surfaces of revolution and of offsets."""

from __future__ import annotations

import math

from ....generated.faces import offset_jet, revolution_jet
from ....generated.jet import at_jet
from ....generated.vectors import Patch
from ....runtime.directions.kernels.vectors import row_vector, set_jet
from ....runtime.machine_code.jit import jit


@jit
def revolve(u, curve, out):
    """Write x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) of a surface of revolution about the z axis.

    `u` (k,) are the angles, and `curve` (k, 3, 3) the points of the curve with their first and
    second derivatives by v.
    """
    for k in range(len(u)):
        p, x_u, x_v, x_uu, x_uv, x_vv = revolution_jet(
            row_vector(curve[k], 0), row_vector(curve[k], 1), row_vector(curve[k], 2),
            math.cos(u[k]), math.sin(u[k]),
        )  # fmt: skip
        set_jet(out[k], p, x_u, x_v, x_uu, x_uv, x_vv)


@jit
def offset(distance, jets, thirds, out):
    """Write y, y_u, y_v, y_uu, y_uv, y_vv (k, 6, 3) of an offset y of a surface x.

    `jets` (k, 6, 3) are x, x_u, x_v, x_uu, x_uv, x_vv, and `thirds` (k, 4, 3) the third derivatives
    x_uuu, x_uuv, x_uvv, x_vvv, which the second derivatives of y need. The results are NaN where
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
