"""The catalogue of parametric surfaces: positions and derivatives at many parameters.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math


def torus(major, minor, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 69 operations as written, 21 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = minor * math.cos(v)
        t2 = major + t1
        t3 = t0 * t2
        jets[row, 0, 0] = t3
        t4 = math.sin(u)
        t5 = t2 * t4
        jets[row, 0, 1] = t5
        t6 = minor * math.sin(v)
        jets[row, 0, 2] = t6
        jets[row, 1, 0] = -t5
        jets[row, 1, 1] = t3
        jets[row, 1, 2] = 0
        t7 = -t0 * t6
        jets[row, 2, 0] = t7
        t8 = t4 * t6
        jets[row, 2, 1] = -t8
        jets[row, 2, 2] = t1
        jets[row, 3, 0] = -t3
        jets[row, 3, 1] = -t5
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = t8
        jets[row, 4, 1] = t7
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = -t0 * t1
        jets[row, 5, 1] = -t1 * t4
        jets[row, 5, 2] = -t6


def ellipsoid(a, b, c, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 63 operations as written, 27 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = math.cos(v)
        t2 = a * t1
        t3 = t0 * t2
        jets[row, 0, 0] = t3
        t4 = math.sin(u)
        t5 = b * t1
        t6 = t4 * t5
        jets[row, 0, 1] = t6
        t7 = math.sin(v)
        t8 = c * t7
        jets[row, 0, 2] = t8
        jets[row, 1, 0] = -t2 * t4
        jets[row, 1, 1] = t0 * t5
        jets[row, 1, 2] = 0
        t9 = a * t7
        jets[row, 2, 0] = -t0 * t9
        t10 = b * t7
        jets[row, 2, 1] = -t10 * t4
        jets[row, 2, 2] = c * t1
        jets[row, 3, 0] = -t3
        jets[row, 3, 1] = -t6
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = t4 * t9
        jets[row, 4, 1] = -t0 * t10
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = -t3
        jets[row, 5, 1] = -t6
        jets[row, 5, 2] = -t8


def ellipsoid_patch(a, b, c, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 63 operations as written, 27 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = math.cos(v)
        t2 = a * t1
        t3 = t0 * t2
        jets[row, 0, 0] = t3
        t4 = math.sin(u)
        t5 = b * t1
        t6 = t4 * t5
        jets[row, 0, 1] = t6
        t7 = math.sin(v)
        t8 = c * t7
        jets[row, 0, 2] = t8
        jets[row, 1, 0] = -t2 * t4
        jets[row, 1, 1] = t0 * t5
        jets[row, 1, 2] = 0
        t9 = a * t7
        jets[row, 2, 0] = -t0 * t9
        t10 = b * t7
        jets[row, 2, 1] = -t10 * t4
        jets[row, 2, 2] = c * t1
        jets[row, 3, 0] = -t3
        jets[row, 3, 1] = -t6
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = t4 * t9
        jets[row, 4, 1] = -t0 * t10
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = -t3
        jets[row, 5, 1] = -t6
        jets[row, 5, 2] = -t8


def sphere(radius, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 63 operations as written, 18 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = radius * math.cos(v)
        t2 = t0 * t1
        jets[row, 0, 0] = t2
        t3 = math.sin(u)
        t4 = t1 * t3
        jets[row, 0, 1] = t4
        t5 = radius * math.sin(v)
        jets[row, 0, 2] = t5
        jets[row, 1, 0] = -t4
        jets[row, 1, 1] = t2
        jets[row, 1, 2] = 0
        t6 = -t0 * t5
        jets[row, 2, 0] = t6
        t7 = t3 * t5
        jets[row, 2, 1] = -t7
        jets[row, 2, 2] = t1
        jets[row, 3, 0] = -t2
        jets[row, 3, 1] = -t4
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = t7
        jets[row, 4, 1] = t6
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = -t2
        jets[row, 5, 1] = -t4
        jets[row, 5, 2] = -t5


def hyperboloid(a, b, c, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 58 operations as written, 22 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = math.cosh(v)
        t2 = a * t1
        t3 = t0 * t2
        jets[row, 0, 0] = t3
        t4 = math.sin(u)
        t5 = b * t1
        t6 = t4 * t5
        jets[row, 0, 1] = t6
        t7 = math.sinh(v)
        t8 = c * t7
        jets[row, 0, 2] = t8
        jets[row, 1, 0] = -t2 * t4
        jets[row, 1, 1] = t0 * t5
        jets[row, 1, 2] = 0
        t9 = a * t7
        jets[row, 2, 0] = t0 * t9
        t10 = b * t7
        jets[row, 2, 1] = t10 * t4
        jets[row, 2, 2] = c * t1
        jets[row, 3, 0] = -t3
        jets[row, 3, 1] = -t6
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = -t4 * t9
        jets[row, 4, 1] = t0 * t10
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = t3
        jets[row, 5, 1] = t6
        jets[row, 5, 2] = t8


def elliptic_paraboloid(a, b, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 17 operations as written, 13 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        jets[row, 0, 0] = u
        jets[row, 0, 1] = v
        t0 = 1.0 / (a * a)
        t1 = 1.0 / (b * b)
        jets[row, 0, 2] = t0 * u * u + t1 * v * v
        jets[row, 1, 0] = 1
        jets[row, 1, 1] = 0
        t2 = 2 * t0
        jets[row, 1, 2] = t2 * u
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 1
        t3 = 2 * t1
        jets[row, 2, 2] = t3 * v
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        jets[row, 3, 2] = t2
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = t3


def hyperbolic_paraboloid(a, b, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 17 operations as written, 15 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        jets[row, 0, 0] = u
        jets[row, 0, 1] = v
        t0 = 1.0 / (b * b)
        t1 = 1.0 / (a * a)
        jets[row, 0, 2] = t1 * u * u - t0 * v * v
        jets[row, 1, 0] = 1
        jets[row, 1, 1] = 0
        t2 = 2 * t1
        jets[row, 1, 2] = t2 * u
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 1
        t3 = 2 * t0
        jets[row, 2, 2] = -t3 * v
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        jets[row, 3, 2] = t2
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = -t3


def monkey_saddle(scale, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 22 operations as written, 18 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        jets[row, 0, 0] = u
        jets[row, 0, 1] = v
        t0 = 3 * v * v
        jets[row, 0, 2] = scale * (u * u * u - t0 * u)
        jets[row, 1, 0] = 1
        jets[row, 1, 1] = 0
        jets[row, 1, 2] = scale * (3 * u * u - t0)
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 1
        t1 = 6 * scale
        t2 = t1 * u
        jets[row, 2, 2] = -t2 * v
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        jets[row, 3, 2] = t2
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = -t1 * v
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = -t2


def enneper(scale, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 54 operations as written, 31 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = v * v
        jets[row, 0, 0] = scale * (t0 * u - (1.0 / 3.0) * u * u * u + u)
        t1 = u * u
        jets[row, 0, 1] = scale * (t1 * v - (1.0 / 3.0) * v * v * v + v)
        t2 = t1 - t0
        jets[row, 0, 2] = scale * t2
        jets[row, 1, 0] = scale * (t0 - t1 + 1)
        t3 = 2 * scale
        t4 = t3 * u
        t5 = t4 * v
        jets[row, 1, 1] = t5
        jets[row, 1, 2] = t4
        jets[row, 2, 0] = t5
        jets[row, 2, 1] = scale * (t2 + 1)
        t6 = t3 * v
        jets[row, 2, 2] = -t6
        jets[row, 3, 0] = -t4
        jets[row, 3, 1] = t6
        jets[row, 3, 2] = t3
        jets[row, 4, 0] = t6
        jets[row, 4, 1] = t4
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = t4
        jets[row, 5, 1] = -t6
        jets[row, 5, 2] = -t3


def catenoid(radius, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 53 operations as written, 15 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = radius * math.cosh(v)
        t2 = t0 * t1
        jets[row, 0, 0] = t2
        t3 = math.sin(u)
        t4 = t1 * t3
        jets[row, 0, 1] = t4
        jets[row, 0, 2] = radius * v
        jets[row, 1, 0] = -t4
        jets[row, 1, 1] = t2
        jets[row, 1, 2] = 0
        t5 = radius * math.sinh(v)
        t6 = t0 * t5
        jets[row, 2, 0] = t6
        t7 = t3 * t5
        jets[row, 2, 1] = t7
        jets[row, 2, 2] = radius
        jets[row, 3, 0] = -t2
        jets[row, 3, 1] = -t4
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = -t7
        jets[row, 4, 1] = t6
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = t2
        jets[row, 5, 1] = t4
        jets[row, 5, 2] = 0


def helicoid(pitch, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 21 operations as written, 9 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(v)
        t1 = t0 * u
        jets[row, 0, 0] = t1
        t2 = math.sin(v)
        t3 = t2 * u
        jets[row, 0, 1] = t3
        jets[row, 0, 2] = pitch * v
        jets[row, 1, 0] = t0
        jets[row, 1, 1] = t2
        jets[row, 1, 2] = 0
        jets[row, 2, 0] = -t3
        jets[row, 2, 1] = t1
        jets[row, 2, 2] = pitch
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = -t2
        jets[row, 4, 1] = t0
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = -t1
        jets[row, 5, 1] = -t3
        jets[row, 5, 2] = 0


def moebius_band(radius, half_width, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 142 operations as written, 44 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = 0.5 * u
        t2 = math.sin(t1)
        t3 = half_width * t2
        t4 = t3 * v
        t5 = radius + t4
        t6 = t0 * t5
        jets[row, 0, 0] = t6
        t7 = math.sin(u)
        t8 = t5 * t7
        jets[row, 0, 1] = t8
        t9 = math.cos(t1)
        t10 = half_width * t9
        t11 = t10 * v
        jets[row, 0, 2] = t11
        jets[row, 1, 0] = 0.5 * t0 * t11 - t8
        t12 = t11 * t7
        jets[row, 1, 1] = 0.5 * t12 + t6
        jets[row, 1, 2] = -0.5 * t4
        t13 = t0 * t2
        t14 = half_width * t13
        jets[row, 2, 0] = t14
        t15 = t2 * t7
        t16 = half_width * t15
        jets[row, 2, 1] = t16
        jets[row, 2, 2] = t10
        t17 = 0.25 * v
        jets[row, 3, 0] = -t12 - t14 * t17 - t6
        jets[row, 3, 1] = half_width * t0 * t9 * v - t16 * t17 - t8
        jets[row, 3, 2] = -0.25 * t11
        jets[row, 4, 0] = half_width * (0.5 * t0 * t9 - t15)
        jets[row, 4, 1] = half_width * (t13 + 0.5 * t7 * t9)
        jets[row, 4, 2] = -0.5 * t3
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = 0


def dupin_cyclide(a, b, d, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 1313 operations as written, 173 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(v)
        t1 = math.cos(u)
        t2 = b * b
        t3 = a * a - t2
        t4 = math.sqrt(t3)
        t5 = t1 * t4
        t6 = t0 * t5
        t7 = a - t6
        t8 = 1.0 / t7
        t9 = t1 * t2
        t10 = t0 * t1
        t11 = a * t10 - t4
        t12 = t9 - d * t11
        jets[row, 0, 0] = t12 * t8
        t13 = d * t0
        t14 = a - t13
        t15 = math.sin(u)
        t16 = b * t8
        t17 = t15 * t16
        t18 = t14 * t17
        jets[row, 0, 1] = t18
        t19 = d - t5
        t20 = math.sin(v)
        t21 = t16 * t20
        jets[row, 0, 2] = -t19 * t21
        t22 = a * t13
        t23 = t0 * t4
        t24 = 1.0 / (t7 * t7)
        t25 = t12 * t24
        jets[row, 1, 0] = t8 * (t15 * t22 - t15 * t2) - t15 * t23 * t25
        t26 = t1 * t8
        t27 = b * t14
        t28 = t15 * t15
        t29 = t23 * t24
        jets[row, 1, 1] = t26 * t27 - t27 * t28 * t29
        t30 = t17 * t20
        t31 = -b * t19
        t32 = t15 * t20
        jets[row, 1, 2] = -t29 * t31 * t32 - t30 * t4
        t33 = a * d
        jets[row, 2, 0] = t20 * t26 * t33 - t20 * t25 * t5
        jets[row, 2, 1] = d * t30 - t24 * t27 * t32 * t5
        t34 = t0 * t8
        t35 = t20 * t20
        t36 = t35 * t5
        jets[row, 2, 2] = t31 * t34 - t24 * t31 * t36
        t37 = t22 - t2
        t38 = t37 * t8
        t39 = 2 * t28
        t40 = t9 - d * t11
        t41 = t3 * t34 * t39
        t42 = t34 * (t5 - t41)
        jets[row, 3, 0] = t8 * (t1 * t37 - t23 * t38 * t39 - t40 * t42)
        t43 = 2 * t8
        t44 = t43 * t6 + 1
        jets[row, 3, 1] = -t18 * (t42 + t44)
        jets[row, 3, 2] = t21 * (t19 * t42 + t41 - t5)
        jets[row, 4, 0] = (
            t32
            * t8
            * (2 * t0 * t1 * t24 * t3 * t40 - t22 * t5 * t8 - t33 - t38 * t5 + t4 * t40 * t8)
        )
        t45 = t4 * t8
        t46 = t14 * t28
        t47 = 2 * t10 * t24
        jets[row, 4, 1] = t21 * (
            d * t1 - t1 * t1 * t14 * t45 - t13 * t28 * t45 + t3 * t46 * t47 + t45 * t46
        )
        t48 = t3 * t35
        jets[row, 4, 2] = t17 * (
            t0 * t0 * t19 * t4 * t8 + t1 * t3 * t35 * t8 - t19 * t35 * t45 - t19 * t47 * t48 - t23
        )
        t49 = t36 * t43
        t50 = t23 - 2 * t26 * t48
        jets[row, 5, 0] = t26 * (a * d * t0 - t33 * t49 - t40 * t50 * t8)
        t51 = t26 * t50
        jets[row, 5, 1] = t17 * (t13 - d * t49 - t14 * t51)
        jets[row, 5, 2] = t19 * t21 * (t44 + t51)


def wavy_graph(amplitude, frequency, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 48 operations as written, 20 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        jets[row, 0, 0] = u
        jets[row, 0, 1] = v
        t0 = frequency * u
        t1 = math.sin(t0)
        t2 = frequency * v
        t3 = amplitude * math.cos(t2)
        t4 = t1 * t3
        jets[row, 0, 2] = t4
        jets[row, 1, 0] = 1
        jets[row, 1, 1] = 0
        t5 = math.cos(t0)
        jets[row, 1, 2] = frequency * t3 * t5
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 1
        t6 = amplitude * math.sin(t2)
        jets[row, 2, 2] = -frequency * t1 * t6
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        t7 = frequency * frequency
        t8 = -t4 * t7
        jets[row, 3, 2] = t8
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = -t5 * t6 * t7
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = t8


def cylinder(radius, height, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 16 operations as written, 8 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = radius * math.cos(u)
        jets[row, 0, 0] = t0
        t1 = radius * math.sin(u)
        jets[row, 0, 1] = t1
        jets[row, 0, 2] = height * v
        jets[row, 1, 0] = -t1
        jets[row, 1, 1] = t0
        jets[row, 1, 2] = 0
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 0
        jets[row, 2, 2] = height
        jets[row, 3, 0] = -t0
        jets[row, 3, 1] = -t1
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = 0


def cone(bottom, top, height, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 47 operations as written, 22 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(u)
        t1 = bottom - top
        t2 = bottom - t1 * v
        t3 = t0 * t2
        jets[row, 0, 0] = t3
        t4 = math.sin(u)
        t5 = t2 * t4
        jets[row, 0, 1] = t5
        jets[row, 0, 2] = height * v
        jets[row, 1, 0] = -t5
        jets[row, 1, 1] = t3
        jets[row, 1, 2] = 0
        jets[row, 2, 0] = -t0 * t1
        jets[row, 2, 1] = -t1 * t4
        jets[row, 2, 2] = height
        t6 = bottom - t1 * v
        jets[row, 3, 0] = -t0 * t6
        jets[row, 3, 1] = -t4 * t6
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = t1 * t4
        jets[row, 4, 1] = -t0 * t1
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = 0


def plane(slope_u, slope_v, u_values, v_values, jets):
    """Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name.

    Source: beyond the paper; 3 operations as written, 3 here.
    Arrays: u_values (k,), v_values (k,), jets (k, 6, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        jets[row, 0, 0] = u
        jets[row, 0, 1] = v
        jets[row, 0, 2] = slope_u * u + slope_v * v
        jets[row, 1, 0] = 1
        jets[row, 1, 1] = 0
        jets[row, 1, 2] = slope_u
        jets[row, 2, 0] = 0
        jets[row, 2, 1] = 1
        jets[row, 2, 2] = slope_v
        jets[row, 3, 0] = 0
        jets[row, 3, 1] = 0
        jets[row, 3, 2] = 0
        jets[row, 4, 0] = 0
        jets[row, 4, 1] = 0
        jets[row, 4, 2] = 0
        jets[row, 5, 0] = 0
        jets[row, 5, 1] = 0
        jets[row, 5, 2] = 0


JETS = {
    "torus": torus,
    "ellipsoid": ellipsoid,
    "ellipsoid_patch": ellipsoid_patch,
    "sphere": sphere,
    "hyperboloid": hyperboloid,
    "elliptic_paraboloid": elliptic_paraboloid,
    "hyperbolic_paraboloid": hyperbolic_paraboloid,
    "monkey_saddle": monkey_saddle,
    "enneper": enneper,
    "catenoid": catenoid,
    "helicoid": helicoid,
    "moebius_band": moebius_band,
    "dupin_cyclide": dupin_cyclide,
    "wavy_graph": wavy_graph,
    "cylinder": cylinder,
    "cone": cone,
    "plane": plane,
}
