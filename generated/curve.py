"""Planar curves: arcs, evaluation, what a sample holds.

Written by `make generate` (python -m gaussmap.symbolic): do not edit, change symbolic/ instead.
SymPy 1.14.0. Passes: common subexpressions of all outputs together, in canonical order;
temporaries that are used once or are another name with a sign written back. float64, no
fast-math.
"""

import math

import numba

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def jit(function):
    """Compile on the first call; keep the machine code on disk where a folder can be written."""
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    except RuntimeError:  # no writable cache folder
        return numba.njit(**OPTIONS)(function)


# --- formulas -------------------------------------------------------------------------------------


@jit
def arc_power_form(b20_x, b20_y, b11_x, b11_y, b02_x, b02_y):
    """The vectors a, b, c of an arc from its control points.

        a = 2*b02 - 4*b11 + 2*b20
        b = 2*(b11 - b20)
        c = b20

    Source: Sect. 4.1; 16 operations as written, 14 here.
    """
    t0 = 2 * b20_x
    a_x = 2 * b02_x - 4 * b11_x + t0
    t1 = 2 * b20_y
    a_y = 2 * b02_y - 4 * b11_y + t1
    b_x = 2 * b11_x - t0
    b_y = 2 * b11_y - t1
    c_x = b20_x
    c_y = b20_y
    return a_x, a_y, b_x, b_y, c_x, c_y


@jit
def arc_parameter(a_x, a_y, b_x, b_y, n_x, n_y):
    """The parameter at which the tangent of the arc is perpendicular to n.

        A = n·a
        B = n·b
        t = - B/A

    Source: eq. (9), in the plane: Sect. 4.1; 8 operations as written, 8 here.
    """
    A = a_x * n_x + a_y * n_y
    B = b_x * n_x + b_y * n_y
    t = -B / A
    return t


@jit
def arc_support_function(a_x, a_y, b_x, b_y, c_x, c_y, n_x, n_y):
    """The support function of an arc: a quadratic over a linear form in n, homogeneous of
    degree 1 and odd.

        A = n·a
        B = n·b
        h = n·c - B**2/(2*A)

    Source: eqs. (3) and (9), in the plane: Sect. 4.1; 13 operations as written, 13 here.
    """
    A = a_x * n_x + a_y * n_y
    B = b_x * n_x + b_y * n_y
    h = c_x * n_x + c_y * n_y - 0.5 * B * B / A
    return h


@jit
def arc_envelope(a_x, a_y, b_x, b_y, c_x, c_y, t):
    """The envelope operator: the gradient of the support function is the point of the arc that
    has the normal n, p(t(n)).

        x = a*t**2/2 + b*t + c

    Source: eqs. (5)-(8), in the plane: Sect. 4.1; 12 operations as written, 10 here.
    """
    t0 = 0.5 * t * t
    x_x = a_x * t0 + b_x * t + c_x
    x_y = a_y * t0 + b_y * t + c_y
    return x_x, x_y


@jit
def arc_tangent(a_x, a_y, b_x, b_y, t):
    """The tangent vector, and the normal: the tangent after a quarter turn clockwise.

        p_t = a*t + b
        N_x = p_t_y
        N_y = - p_t_x

    Source: eq. (1), in the plane: Sect. 4.1; 5 operations as written, 5 here.
    """
    p_t_x = a_x * t + b_x
    p_t_y = a_y * t + b_y
    N_x = p_t_y
    N_y = -p_t_x
    return p_t_x, p_t_y, N_x, N_y


@jit
def arc_curvature(A, p_t_x, p_t_y):
    """The curvature at the point with the unit normal n: the reciprocal of the radius of
    curvature, which is the trace of the Hessian of the support function (positive on a circle
    with outward normals).

        kappa = - A/|p_t|**2

    Source: beyond the paper: Sect. 4.1; 5 operations as written, 5 here.
    """
    kappa = -A / (p_t_x * p_t_x + p_t_y * p_t_y)
    return kappa


@jit
def arc_curvature_at(a_x, a_y, p_t_x, p_t_y):
    """The curvature at a parameter, for the normal n = N/|N| of `arc_tangent` in
    `arc_curvature`.

        kappa = (det(p_t, a))/|p_t|**3

    Source: beyond the paper: Sect. 4.1; 12 operations as written, 12 here.
    """
    kappa = (a_y * p_t_x - a_x * p_t_y) / (
        (p_t_x * p_t_x + p_t_y * p_t_y) * math.sqrt(p_t_x * p_t_x + p_t_y * p_t_y)
    )
    return kappa


@jit
def arc_control_points(mu_l_x, mu_l_y, mu_c_x, mu_c_y, mu_r_x, mu_r_y):
    """The control points of an arc of the quadratic spline from the coefficients of its piece
    and the two next to it.

        b20 = (mu_c + mu_l)/2
        b11 = mu_c
        b02 = (mu_c + mu_r)/2

    Source: Sect. 4.1; 12 operations as written, 10 here.
    """
    t0 = 0.5 * mu_c_x
    b20_x = 0.5 * mu_l_x + t0
    t1 = 0.5 * mu_c_y
    b20_y = 0.5 * mu_l_y + t1
    b11_x = mu_c_x
    b11_y = mu_c_y
    b02_x = 0.5 * mu_r_x + t0
    b02_y = 0.5 * mu_r_y + t1
    return b20_x, b20_y, b11_x, b11_y, b02_x, b02_y


@jit
def arc(mu_l_x, mu_l_y, mu_r_x, mu_r_y):
    """The vectors of an arc of the spline, c relative to the coefficient of its piece, from the
    differences mu_l, mu_r of the neighbouring coefficients from that one.

        a = mu_l + mu_r
        b = - mu_l
        c = mu_l/2

    Source: Sect. 4.1; 6 operations as written, 6 here.
    """
    a_x = mu_l_x + mu_r_x
    a_y = mu_l_y + mu_r_y
    b_x = -mu_l_x
    b_y = -mu_l_y
    c_x = 0.5 * mu_l_x
    c_y = 0.5 * mu_l_y
    return a_x, a_y, b_x, b_y, c_x, c_y


@jit
def beyond_end(f, mu_c):
    """The coefficient beyond an end of an open curve from that of the last piece and the value
    f at the end, which the spline interpolates.

        mu_l = 2*f - mu_c

    Source: Sect. 4.1; 2 operations as written, 2 here.
    """
    mu_l = 2 * f - mu_c
    return mu_l


# --- reading the spline ---------------------------------------------------------------------------


@jit
def evaluate(mu, scale, places, points, normals, curvatures):
    """Write points (k, 2), unnormalized normals (k, 2) and curvatures (k,) at places (k,), in pieces."""
    for k in range(places.size):
        i = min(max(int(math.floor(places[k])), 0), mu.shape[0] - 3)
        t = places[k] - i
        mu_l_x = scale * (mu[i, 0] - mu[i + 1, 0])
        mu_l_y = scale * (mu[i, 1] - mu[i + 1, 1])
        mu_r_x = scale * (mu[i + 2, 0] - mu[i + 1, 0])
        mu_r_y = scale * (mu[i + 2, 1] - mu[i + 1, 1])
        # arc (Sect. 4.1): 6 operations as written, 6 here
        a_x = mu_l_x + mu_r_x
        a_y = mu_l_y + mu_r_y
        b_x = -mu_l_x
        b_y = -mu_l_y
        c_x = 0.5 * mu_l_x
        c_y = 0.5 * mu_l_y
        # arc_envelope (eqs. (5)-(8), in the plane: Sect. 4.1): 12 operations as written, 10 here
        t0 = 0.5 * t * t
        x_x = a_x * t0 + b_x * t + c_x
        x_y = a_y * t0 + b_y * t + c_y
        # arc_tangent (eq. (1), in the plane: Sect. 4.1): 5 operations as written, 5 here
        p_t_x = a_x * t + b_x
        p_t_y = a_y * t + b_y
        N_x = p_t_y
        N_y = -p_t_x
        # arc_curvature_at (beyond the paper: Sect. 4.1): 12 operations as written, 12 here
        kappa = (a_y * p_t_x - a_x * p_t_y) / (
            (p_t_x * p_t_x + p_t_y * p_t_y) * math.sqrt(p_t_x * p_t_x + p_t_y * p_t_y)
        )
        points[k, 0] = mu[i + 1, 0] + x_x / scale
        points[k, 1] = mu[i + 1, 1] + x_y / scale
        normals[k, 0] = N_x
        normals[k, 1] = N_y
        curvatures[k] = kappa * scale


# --- how the normal turns --------------------------------------------------------------------------


@jit
def settle(angles, turns, errors, start):
    """Let the normal of a joint be that of the joint before where only rounding tells them apart.

    angles + 2 pi turns (P + 1,) are those of the joints, errors (P + 1,) their rounding. A closed curve
    is gone round from the joint `start` > 0; start = 0 is the first joint of an open one.
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


# --- what a sample holds --------------------------------------------------------------------------


@jit
def fill_samples(
    mu, scale, normals, start, step, piece_index, normal_index, signs,
    points, directions, parameters, support, curvatures,
):  # fmt: skip
    """Fill the samples from the piece, the normal and the sign of the curvature of each.

    Piece i begins at the parameter start + i step.
    """
    for k in range(piece_index.size):
        i = piece_index[k]
        n_x = normals[normal_index[k], 0]
        n_y = normals[normal_index[k], 1]
        mu_l_x = scale * (mu[i, 0] - mu[i + 1, 0])
        mu_l_y = scale * (mu[i, 1] - mu[i + 1, 1])
        mu_r_x = scale * (mu[i + 2, 0] - mu[i + 1, 0])
        mu_r_y = scale * (mu[i + 2, 1] - mu[i + 1, 1])
        # arc (Sect. 4.1): 6 operations as written, 6 here
        a_x = mu_l_x + mu_r_x
        a_y = mu_l_y + mu_r_y
        b_x = -mu_l_x
        b_y = -mu_l_y
        c_x = 0.5 * mu_l_x
        c_y = 0.5 * mu_l_y
        # arc_parameter (eq. (9), in the plane: Sect. 4.1): 8 operations as written, 8 here
        A = a_x * n_x + a_y * n_y
        B = b_x * n_x + b_y * n_y
        t = -B / A
        # Where rounding hides the turn of an arc, it hides the place of the normal on it.
        t = min(max(t, 0.0), 1.0) if A != 0.0 else 0.5
        # arc_sample (eqs. (5)-(8), in the plane: Sect. 4.1): 21 operations as written, 19 here
        t0 = 0.5 * t * t
        x_x = a_x * t0 + b_x * t + c_x
        x_y = a_y * t0 + b_y * t + c_y
        p_t_x = a_x * t + b_x
        p_t_y = a_y * t + b_y
        kappa = -A / (p_t_x * p_t_x + p_t_y * p_t_y)
        points[k, 0] = mu[i + 1, 0] + x_x / scale
        points[k, 1] = mu[i + 1, 1] + x_y / scale
        directions[k, 0] = n_x
        directions[k, 1] = n_y
        parameters[k] = start + step * (i + t)
        support[k] = n_x * points[k, 0] + n_y * points[k, 1]
        curvatures[k] = math.copysign(kappa * scale, signs[k])
