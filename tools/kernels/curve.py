"""The planar C¹ quadratic spline: its arcs, its evaluation, and the samples at normals."""

from __future__ import annotations

import math

from ...generated.curve import (
    arc,
    arc_curvature_at,
    arc_envelope,
    arc_parameter,
    arc_sample,
    arc_tangent,
)
from ...generated.vectors import PlaneVector
from ...runtime.kernels.jit import inline, jit

__all__ = ["evaluate", "fill_samples", "merge_joints"]


@inline
def arc_of_piece(mu, i, scale):
    """Return the vectors of the arc of a piece, times `scale`.

    The coefficients mu (P + 2, 2) include ghost coefficients: that of piece i is mu[i + 1], and c
    is relative to it.
    """
    return arc(
        PlaneVector(scale * (mu[i, 0] - mu[i + 1, 0]), scale * (mu[i, 1] - mu[i + 1, 1])),
        PlaneVector(scale * (mu[i + 2, 0] - mu[i + 1, 0]), scale * (mu[i + 2, 1] - mu[i + 1, 1])),
    )


@jit
def evaluate(mu, scale, places, points, normals, curvatures):
    """Write points (k, 2), normals of any length (k, 2) and curvatures (k,) at `places` (k,).

    These are parameters in units of pieces, from the beginning of the spline.
    """
    for k in range(places.size):
        i = min(max(int(math.floor(places[k])), 0), mu.shape[0] - 3)
        t = places[k] - i
        vectors = arc_of_piece(mu, i, scale)
        x = arc_envelope(vectors, t)
        p_t, N_x, N_y = arc_tangent(vectors, t)
        points[k, 0] = mu[i + 1, 0] + x.x / scale
        points[k, 1] = mu[i + 1, 1] + x.y / scale
        normals[k, 0] = N_x
        normals[k, 1] = N_y
        curvatures[k] = arc_curvature_at(vectors.a, p_t) * scale


@jit
def merge_joints(angles, turns, errors, start):
    """Give neighbouring joints one normal if their normals differ only by rounding.

    angles + 2 pi turns (P + 1,) are the angles at joints, errors (P + 1,) their rounding. The
    joints of a closed curve are visited from the joint `start` > 0 on; start = 0 is the first joint
    of an open curve.
    """
    pieces = angles.size - 1
    whole = turns[pieces] - turns[0]
    for k in range(start, start + pieces - (1 if start > 0 else 0)):
        before = k % pieces
        here = before + 1
        step = angles[here] - angles[before] + 2.0 * math.pi * (turns[here] - turns[before])
        if abs(step) <= 2.0 * min(errors[here], errors[before]):
            angles[here] = angles[before]
            turns[here] = turns[before]
            if here == pieces and start > 0:
                angles[0] = angles[here]
                turns[0] = turns[here] - whole


@jit
def fill_samples(
    mu, scale, normals, start, step, piece_index, normal_index, signs,
    points, directions, parameters, support, curvatures,
):  # fmt: skip
    """Write the samples (k,) from the piece, the normal and the sign of the curvature of each.

    normals (S, 2) are of unit length. Piece i begins at the parameter start + i step.
    """
    for k in range(piece_index.size):
        i = piece_index[k]
        n = PlaneVector(normals[normal_index[k], 0], normals[normal_index[k], 1])
        vectors = arc_of_piece(mu, i, scale)
        A = n.x * vectors.a.x + n.y * vectors.a.y
        # If the turn of an arc is within rounding, so is the parameter of the normal.
        t = min(max(arc_parameter(vectors, n), 0.0), 1.0) if A != 0.0 else 0.5
        x, kappa = arc_sample(vectors, t, A)
        points[k, 0] = mu[i + 1, 0] + x.x / scale
        points[k, 1] = mu[i + 1, 1] + x.y / scale
        directions[k, 0] = n.x
        directions[k, 1] = n.y
        parameters[k] = start + step * (i + t)
        support[k] = n.x * points[k, 0] + n.y * points[k, 1]
        curvatures[k] = math.copysign(kappa * scale, signs[k])
