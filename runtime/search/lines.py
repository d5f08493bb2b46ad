"""Normals that all points of a line of nets have, such as the circle on top of a torus.

In a patch on such a line all forms of the normal are 0, and rounding gives each corner on the line
its own normal. So the search displaces the normal by more than rounding, and the points found are
moved back to the line.
"""

import numpy as np

from ...generated import patch as formulas
from ..base.aliases import Array, Flags, Indices
from ..base.formula_calls import python_function, vector
from ..spline.nets import NetSpline
from .in_nets import rounding_of

# Normals are displaced by BESIDE times the rounding error of coordinates: the angle by which
# rounding turns normals is about that error. DIRECTION is in no plane of symmetry.
BESIDE, DIRECTION = 64.0, np.array([1.0, 1e-2, 1e-4])


def have_lines(spline: NetSpline, patches: Indices, normals: Array) -> Flags:
    """Return a mask (k,) of the patches with a line all of whose points have the given normal.

    `normals` (k, 3) has a normal for each of the k `patches`; forms count as 0 up to rounding. The
    mask is False for patches with a collapsed edge, or with a singular corner at a pole.
    """
    topology = spline.topology
    forms = python_function(formulas.forms)(spline.patch(patches), vector(normals))
    small = (np.abs(forms) <= rounding_of(spline, patches)).all(axis=0)
    small &= ~topology.is_point.reshape(-1, 3)[patches].any(axis=1)
    return small & (topology.pole_corner[patches] < 0)


def beside_lines(spline: NetSpline, normals: Array) -> Array:
    """Return displaced unit normals (k, 3); opposite normals are displaced to opposite ones."""
    first = np.take_along_axis(normals, (normals != 0.0).argmax(axis=1)[:, None], axis=1)
    moved = normals + BESIDE * spline.noise * np.sign(first) * DIRECTION
    return moved / np.linalg.norm(moved, axis=1, keepdims=True)


def places_at(spline: NetSpline, patches: Indices, normals: Array, beside: Array) -> Array:
    """Return the parameters (k, 2) of points with the normals (k, 3).

    If a line of the patch has the normal, the result is the point of the line that is nearest to
    the point with the displaced normal in `beside`.
    """
    uv, lines = np.full((len(patches), 2), 1.0 / 3.0), have_lines(spline, patches, normals)
    for n, on_lines in ((beside, np.zeros_like(lines)), (normals, lines)):
        A, B, C, P, Q = python_function(formulas.linear_forms)(spline.patch(patches), vector(n))
        hessian = np.array([[A, B], [B, C]])
        values, axes = np.linalg.eigh(hessian.transpose(2, 0, 1))
        slopes = np.einsum("ijk,kj->ik", hessian, uv) + np.stack([P, Q])
        steps, sizes = np.einsum("kij,ik->kj", axes, slopes), np.abs(values)
        along = on_lines[:, None] & (sizes < sizes.max(axis=1, keepdims=True))
        steps = np.divide(steps, values, out=np.zeros_like(steps), where=~along & (sizes > 0.0))
        u, v = (uv - np.einsum("kij,kj->ki", axes, steps)).T
        bars = np.maximum([u, v, 1.0 - u - v], 0.0)
        uv = (bars / bars.sum(axis=0))[:2].T
    return uv
