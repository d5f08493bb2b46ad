"""The catalogue of parametric surfaces: evaluation loops and data.

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


@jit
def torus(parameters, points, major, minor):
    """The torus round the z axis, u being the angle round the axis and v the angle round the
    tube, from its outer equator upwards, with normals pointing out of the tube.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # torus (beyond the paper): 12 operations as written, 9 here
        t0 = major + minor * math.cos(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = minor * math.sin(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def ellipsoid(parameters, points, a, b, c):
    """The whole ellipsoid x²/a² + y²/b² + z²/c² = 1, with the longitude u, the latitude v
    (angles on the unit sphere that is stretched), poles at z = ±c, and outward normals.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # ellipsoid (beyond the paper): 10 operations as written, 9 here
        t0 = math.cos(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sin(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def ellipsoid_patch(parameters, points, a, b, c):
    """The belt of the ellipsoid between the latitudes v = ±π/3, so without its poles, with the
    longitude u and outward normals.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # ellipsoid_patch (beyond the paper): 10 operations as written, 9 here
        t0 = math.cos(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sin(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def sphere(parameters, points, radius):
    """The whole sphere round the origin, with the longitude u, the latitude v, poles on the z
    axis, and outward normals.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # sphere (beyond the paper): 10 operations as written, 8 here
        t0 = radius * math.cos(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = radius * math.sin(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def hyperboloid(parameters, points, a, b, c):
    """The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1, u going
    round the z axis and v along it, with normals pointing away from the axis.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # hyperboloid (beyond the paper): 10 operations as written, 9 here
        t0 = math.cosh(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sinh(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def elliptic_paraboloid(parameters, points, a, b):
    """The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to its
    inside.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # elliptic_paraboloid (beyond the paper): 7 operations as written, 7 here
        x_x = u
        x_y = v
        x_z = v * v / (b * b) + u * u / (a * a)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def hyperbolic_paraboloid(parameters, points, a, b):
    """The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals."""
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # hyperbolic_paraboloid (beyond the paper): 7 operations as written, 7 here
        x_x = u
        x_y = v
        x_z = u * u / (a * a) - v * v / (b * b)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def monkey_saddle(parameters, points, scale):
    """The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward normals
    and a flat point at the origin.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # monkey_saddle (beyond the paper): 7 operations as written, 7 here
        x_x = u
        x_y = v
        x_z = scale * (u * u * u - 3 * u * v * v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def enneper(parameters, points, scale):
    """Enneper's minimal surface, without the self-intersections that it has farther out, in
    conformal parameters, with its normal at the origin pointing upwards.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # enneper (beyond the paper): 20 operations as written, 18 here
        t0 = v * v
        x_x = scale * (t0 * u - (1.0 / 3.0) * u * u * u + u)
        t1 = u * u
        x_y = scale * (t1 * v - (1.0 / 3.0) * v * v * v + v)
        x_z = scale * (t1 - t0)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def catenoid(parameters, points, radius):
    """The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius, u being
    the angle round the z axis and v = z/radius, with normals pointing away from the axis.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # catenoid (beyond the paper): 9 operations as written, 7 here
        t0 = radius * math.cosh(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = radius * v
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def helicoid(parameters, points, pitch):
    """One turn of the right-handed helicoid, u being the signed distance from the z axis and v
    the angle, with normals pointing upwards where u > 0 and downwards where u < 0.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # helicoid (beyond the paper): 5 operations as written, 5 here
        x_x = u * math.cos(v)
        x_y = u * math.sin(v)
        x_z = pitch * v
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def moebius_band(parameters, points, radius, half_width):
    """The Möbius band round the z axis, u being the angle round the axis and v running across,
    upright at u = 0 with its normal there pointing away from the axis, and with the opposite
    normal after one turn.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # moebius_band (beyond the paper): 18 operations as written, 11 here
        t0 = 0.5 * u
        t1 = half_width * v
        t2 = radius + t1 * math.sin(t0)
        x_x = t2 * math.cos(u)
        x_y = t2 * math.sin(u)
        x_z = t1 * math.cos(t0)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def dupin_cyclide(parameters, points, a, b, d):
    """The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − x
    √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # dupin_cyclide (beyond the paper): 60 operations as written, 28 here
        t0 = math.cos(v)
        t1 = math.cos(u)
        t2 = b * b
        t3 = math.sqrt(a * a - t2)
        t4 = 1.0 / (a - t0 * t1 * t3)
        x_x = t4 * (d * (t3 - a * t0 * t1) + t1 * t2)
        t5 = b * t4
        x_y = t5 * (a - d * t0) * math.sin(u)
        x_z = t5 * (t1 * t3 - d) * math.sin(v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def wavy_graph(parameters, points, amplitude, frequency):
    """The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with upward
    normals.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # wavy_graph (beyond the paper): 6 operations as written, 6 here
        x_x = u
        x_y = v
        x_z = amplitude * math.sin(frequency * u) * math.cos(frequency * v)
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def cylinder(parameters, points, radius, height):
    """The circular cylinder round the z axis, u being the angle and v = z/height, with normals
    pointing away from the axis.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # cylinder (beyond the paper): 5 operations as written, 5 here
        x_x = radius * math.cos(u)
        x_y = radius * math.sin(u)
        x_z = height * v
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def cone(parameters, points, bottom, top, height):
    """The frustum of a circular cone round the z axis, which does not reach the apex, u being
    the angle and v = z/height, with normals pointing away from the axis.
    """
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # cone (beyond the paper): 11 operations as written, 8 here
        t0 = bottom + v * (top - bottom)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = height * v
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


@jit
def plane(parameters, points, slope_u, slope_v):
    """The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals."""
    for k in range(points.shape[0]):
        u = parameters[k, 0]
        v = parameters[k, 1]
        # plane (beyond the paper): 3 operations as written, 3 here
        x_x = u
        x_y = v
        x_z = slope_u * u + slope_v * v
        points[k, 0] = x_x
        points[k, 1] = x_y
        points[k, 2] = x_z


CATALOGUE = {
    "torus": {
        "kernel": torus,
        "sentence": "The torus round the z axis, u being the angle round the axis and v the angle round the tube, from its outer equator upwards, with normals pointing out of the tube.",
        "parameters": {
            "major": (1.0, True, "The radius of the circle in the middle of the tube."),
            "minor": (0.35, True, "The radius of the tube, less than major."),
        },
        "domain": ((0, 2 * math.pi), (0, 2 * math.pi)),
        "ends": (("wrap", "wrap"), ("wrap", "wrap")),
    },
    "ellipsoid": {
        "kernel": ellipsoid,
        "sentence": "The whole ellipsoid x²/a² + y²/b² + z²/c² = 1, with the longitude u, the latitude v (angles on the unit sphere that is stretched), poles at z = ±c, and outward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x."),
            "b": (0.6, True, "The semi-axis along y."),
            "c": (0.3, True, "The semi-axis along z."),
        },
        "domain": ((0, 2 * math.pi), (-0.5 * math.pi, 0.5 * math.pi)),
        "ends": (("wrap", "wrap"), ("pole", "pole")),
    },
    "ellipsoid_patch": {
        "kernel": ellipsoid_patch,
        "sentence": "The belt of the ellipsoid between the latitudes v = ±π/3, so without its poles, with the longitude u and outward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x."),
            "b": (0.6, True, "The semi-axis along y."),
            "c": (0.3, True, "The semi-axis along z."),
        },
        "domain": ((0, 2 * math.pi), (-(1.0 / 3.0) * math.pi, (1.0 / 3.0) * math.pi)),
        "ends": (("wrap", "wrap"), ("none", "none")),
    },
    "sphere": {
        "kernel": sphere,
        "sentence": "The whole sphere round the origin, with the longitude u, the latitude v, poles on the z axis, and outward normals.",
        "parameters": {"radius": (1.0, True, "The radius.")},
        "domain": ((0, 2 * math.pi), (-0.5 * math.pi, 0.5 * math.pi)),
        "ends": (("wrap", "wrap"), ("pole", "pole")),
    },
    "hyperboloid": {
        "kernel": hyperboloid,
        "sentence": "The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1, u going round the z axis and v along it, with normals pointing away from the axis.",
        "parameters": {
            "a": (1.0, True, "The semi-axis of the waist along x."),
            "b": (0.8, True, "The semi-axis of the waist along y."),
            "c": (1.0, True, "The semi-axis along z, imaginary: the waist is at z = 0."),
        },
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "ends": (("wrap", "wrap"), ("none", "none")),
    },
    "elliptic_paraboloid": {
        "kernel": elliptic_paraboloid,
        "sentence": "The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to its inside.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x of the ellipse at z = 1."),
            "b": (1.5, True, "The semi-axis along y of the ellipse at z = 1."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "hyperbolic_paraboloid": {
        "kernel": hyperbolic_paraboloid,
        "sentence": "The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x of the hyperbola at z = 1."),
            "b": (1.5, True, "The semi-axis along y of the hyperbola at z = −1."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "monkey_saddle": {
        "kernel": monkey_saddle,
        "sentence": "The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward normals and a flat point at the origin.",
        "parameters": {"scale": (0.5, True, "The factor of the heights.")},
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "enneper": {
        "kernel": enneper,
        "sentence": "Enneper's minimal surface, without the self-intersections that it has farther out, in conformal parameters, with its normal at the origin pointing upwards.",
        "parameters": {"scale": (1.0, True, "The factor of the size.")},
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "catenoid": {
        "kernel": catenoid,
        "sentence": "The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius, u being the angle round the z axis and v = z/radius, with normals pointing away from the axis.",
        "parameters": {"radius": (1.0, True, "The radius of the waist.")},
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "ends": (("wrap", "wrap"), ("none", "none")),
    },
    "helicoid": {
        "kernel": helicoid,
        "sentence": "One turn of the right-handed helicoid, u being the signed distance from the z axis and v the angle, with normals pointing upwards where u > 0 and downwards where u < 0.",
        "parameters": {"pitch": (0.5, True, "The rise per radian.")},
        "domain": ((-1, 1), (-math.pi, math.pi)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "moebius_band": {
        "kernel": moebius_band,
        "sentence": "The Möbius band round the z axis, u being the angle round the axis and v running across, upright at u = 0 with its normal there pointing away from the axis, and with the opposite normal after one turn.",
        "parameters": {
            "radius": (1.0, True, "The radius of the circle in the middle of the band."),
            "half_width": (0.4, True, "Half the width of the band, less than radius."),
        },
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "ends": (("flip", "flip"), ("none", "none")),
    },
    "dupin_cyclide": {
        "kernel": dupin_cyclide,
        "sentence": "The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − x √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.",
        "parameters": {
            "a": (1.0, True, "The semi-axis of the ellipse along x."),
            "b": (0.96, True, "The semi-axis of the ellipse along y, at most a."),
            "d": (0.5, True, "The mean radius of the tube, √(a² − b²) < d < a for a ring."),
        },
        "domain": ((0, 2 * math.pi), (0, 2 * math.pi)),
        "ends": (("wrap", "wrap"), ("wrap", "wrap")),
    },
    "wavy_graph": {
        "kernel": wavy_graph,
        "sentence": "The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with upward normals.",
        "parameters": {
            "amplitude": (0.2, False, "The height of the waves."),
            "frequency": (3.0, False, "Radians per unit of length."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
    "cylinder": {
        "kernel": cylinder,
        "sentence": "The circular cylinder round the z axis, u being the angle and v = z/height, with normals pointing away from the axis.",
        "parameters": {"radius": (1.0, True, "The radius."), "height": (2.0, True, "The height.")},
        "domain": ((0, 2 * math.pi), (0, 1)),
        "ends": (("wrap", "wrap"), ("none", "none")),
    },
    "cone": {
        "kernel": cone,
        "sentence": "The frustum of a circular cone round the z axis, which does not reach the apex, u being the angle and v = z/height, with normals pointing away from the axis.",
        "parameters": {
            "bottom": (1.0, True, "The radius at z = 0."),
            "top": (0.5, True, "The radius at z = height."),
            "height": (1.0, True, "The height."),
        },
        "domain": ((0, 2 * math.pi), (0, 1)),
        "ends": (("wrap", "wrap"), ("none", "none")),
    },
    "plane": {
        "kernel": plane,
        "sentence": "The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals.",
        "parameters": {
            "slope_u": (0.0, False, "The slope along x."),
            "slope_v": (0.0, False, "The slope along y."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "ends": (("none", "none"), ("none", "none")),
    },
}
