"""The catalogue of parametric surfaces: positions at many parameters, and data.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math


def torus(major, minor, u_values, v_values, points):
    """The torus around the z axis; u is the angle around the axis, v the angle around the tube,
    from its outer equator upwards. Normals point out of the tube.

        x_x = (major + minor*cos(v))*cos(u)
        x_y = (major + minor*cos(v))*sin(u)
        x_z = minor*sin(v)

    Source: beyond the paper; 12 operations as written, 9 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = major + minor * math.cos(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = minor * math.sin(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def ellipsoid(a, b, c, u_values, v_values, points):
    """The whole ellipsoid x²/a² + y²/b² + z²/c² = 1 with the longitude u and the latitude v of
    the sphere that is stretched, poles at z = ±c, and outward normals.

        x_x = a*cos(u)*cos(v)
        x_y = b*sin(u)*cos(v)
        x_z = c*sin(v)

    Source: beyond the paper; 10 operations as written, 9 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sin(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def ellipsoid_patch(a, b, c, u_values, v_values, points):
    """The belt of the ellipsoid between the latitudes v = ±π/3, without its poles, with the
    longitude u and outward normals.

        x_x = a*cos(u)*cos(v)
        x_y = b*sin(u)*cos(v)
        x_z = c*sin(v)

    Source: beyond the paper; 10 operations as written, 9 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sin(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def sphere(radius, u_values, v_values, points):
    """The whole sphere around the origin, with the longitude u, the latitude v, poles on the z
    axis, and outward normals.

        x_x = radius*cos(u)*cos(v)
        x_y = radius*sin(u)*cos(v)
        x_z = radius*sin(v)

    Source: beyond the paper; 10 operations as written, 8 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = radius * math.cos(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = radius * math.sin(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def hyperboloid(a, b, c, u_values, v_values, points):
    """The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1; u goes
    around the z axis, v along it. Normals point away from the axis.

        x_x = a*cos(u)*cosh(v)
        x_y = b*sin(u)*cosh(v)
        x_z = c*sinh(v)

    Source: beyond the paper; 10 operations as written, 9 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cosh(v)
        x_x = a * t0 * math.cos(u)
        x_y = b * t0 * math.sin(u)
        x_z = c * math.sinh(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def elliptic_paraboloid(a, b, u_values, v_values, points):
    """The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to its
    inside.

        x_x = u
        x_y = v
        x_z = v**2/b**2 + u**2/a**2

    Source: beyond the paper; 7 operations as written, 7 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u
        x_y = v
        x_z = v * v / (b * b) + u * u / (a * a)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def hyperbolic_paraboloid(a, b, u_values, v_values, points):
    """The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals.

        x_x = u
        x_y = v
        x_z = u**2/a**2 - v**2/b**2

    Source: beyond the paper; 7 operations as written, 7 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u
        x_y = v
        x_z = u * u / (a * a) - v * v / (b * b)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def monkey_saddle(scale, u_values, v_values, points):
    """The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward normals
    and a flat point at the origin.

        x_x = u
        x_y = v
        x_z = scale*(u**3 - 3*u*v**2)

    Source: beyond the paper; 7 operations as written, 7 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u
        x_y = v
        x_z = scale * (u * u * u - 3 * u * v * v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def enneper(scale, u_values, v_values, points):
    """Enneper's minimal surface, without the self-intersections that it has farther out, in
    conformal parameters, with its normal at the origin pointing upwards.

        x_x = scale*(u*v**2 - u**3/3 + u)
        x_y = scale*(u**2*v - v**3/3 + v)
        x_z = scale*(u**2 - v**2)

    Source: beyond the paper; 20 operations as written, 18 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = v * v
        x_x = scale * (t0 * u - (1.0 / 3.0) * u * u * u + u)
        t1 = u * u
        x_y = scale * (t1 * v - (1.0 / 3.0) * v * v * v + v)
        x_z = scale * (t1 - t0)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def catenoid(radius, u_values, v_values, points):
    """The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius; u is the
    angle around the z axis, v = z/radius. Normals point away from the axis.

        x_x = radius*cos(u)*cosh(v)
        x_y = radius*sin(u)*cosh(v)
        x_z = radius*v

    Source: beyond the paper; 9 operations as written, 7 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = radius * math.cosh(v)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = radius * v
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def helicoid(pitch, u_values, v_values, points):
    """One turn of the right-handed helicoid; u is the signed distance from the z axis, v the
    angle. Normals point upwards where u > 0 and downwards where u < 0.

        x_x = u*cos(v)
        x_y = u*sin(v)
        x_z = pitch*v

    Source: beyond the paper; 5 operations as written, 5 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u * math.cos(v)
        x_y = u * math.sin(v)
        x_z = pitch * v
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def moebius_band(radius, half_width, u_values, v_values, points):
    """The Möbius band around the z axis; u is the angle around the axis, v runs across. It is
    upright at u = 0, where its normal points away from the axis; after one turn the normal is
    opposite.

        x_x = (half_width*v*sin(u/2) + radius)*cos(u)
        x_y = (half_width*v*sin(u/2) + radius)*sin(u)
        x_z = half_width*v*cos(u/2)

    Source: beyond the paper; 18 operations as written, 11 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = 0.5 * u
        t1 = half_width * v
        t2 = radius + t1 * math.sin(t0)
        x_x = t2 * math.cos(u)
        x_y = t2 * math.sin(u)
        x_z = t1 * math.cos(t0)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def dupin_cyclide(a, b, d, u_values, v_values, points):
    """The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − x
    √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.

        x_x = (b**2*cos(u) + d*(sqrt(a**2 - b**2) - a*cos(u)*cos(v)))/(a - sqrt(a**2 - b**2)*cos(u)*cos(v))
        x_y = b*(a - d*cos(v))*sin(u)/(a - sqrt(a**2 - b**2)*cos(u)*cos(v))
        x_z = b*(sqrt(a**2 - b**2)*cos(u) - d)*sin(v)/(a - sqrt(a**2 - b**2)*cos(u)*cos(v))

    Source: beyond the paper; 60 operations as written, 28 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = math.cos(v)
        t1 = math.cos(u)
        t2 = b * b
        t3 = math.sqrt(a * a - t2)
        t4 = 1.0 / (a - t0 * t1 * t3)
        x_x = t4 * (d * (t3 - a * t0 * t1) + t1 * t2)
        t5 = b * t4
        x_y = t5 * (a - d * t0) * math.sin(u)
        x_z = t5 * (t1 * t3 - d) * math.sin(v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def wavy_graph(amplitude, frequency, u_values, v_values, points):
    """The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with upward
    normals.

        x_x = u
        x_y = v
        x_z = amplitude*sin(frequency*u)*cos(frequency*v)

    Source: beyond the paper; 6 operations as written, 6 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u
        x_y = v
        x_z = amplitude * math.sin(frequency * u) * math.cos(frequency * v)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def cylinder(radius, height, u_values, v_values, points):
    """The circular cylinder around the z axis; u is the angle, v = z/height. Normals point away
    from the axis.

        x_x = radius*cos(u)
        x_y = radius*sin(u)
        x_z = height*v

    Source: beyond the paper; 5 operations as written, 5 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = radius * math.cos(u)
        x_y = radius * math.sin(u)
        x_z = height * v
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def cone(bottom, top, height, u_values, v_values, points):
    """The frustum of a circular cone around the z axis, without its apex; u is the angle, v =
    z/height. Normals point away from the axis.

        x_x = (bottom + v*(top - bottom))*cos(u)
        x_y = (bottom + v*(top - bottom))*sin(u)
        x_z = height*v

    Source: beyond the paper; 11 operations as written, 8 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        t0 = bottom + v * (top - bottom)
        x_x = t0 * math.cos(u)
        x_y = t0 * math.sin(u)
        x_z = height * v
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def plane(slope_u, slope_v, u_values, v_values, points):
    """The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals.

        x_x = u
        x_y = v
        x_z = slope_u*u + slope_v*v

    Source: beyond the paper; 3 operations as written, 3 here.
    Arrays: u_values (k,), v_values (k,), points (k, 3).
    """
    for row in range(u_values.shape[0]):
        u = u_values[row]
        v = v_values[row]
        x_x = u
        x_y = v
        x_z = slope_u * u + slope_v * v
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


CATALOGUE = {
    "torus": {
        "position": torus,
        "sentence": "The torus around the z axis; u is the angle around the axis, v the angle around the tube, from its outer equator upwards. Normals point out of the tube.",
        "parameters": {
            "major": (1.0, True, "The radius of the circle in the middle of the tube."),
            "minor": (
                0.35,
                True,
                "The radius of the tube; from major on, the torus meets itself on the axis, where it has singular points.",
            ),
        },
        "domain": ((0, 2 * math.pi), (0, 2 * math.pi)),
        "boundary": (("periodic", "periodic"), ("periodic", "periodic")),
    },
    "ellipsoid": {
        "position": ellipsoid,
        "sentence": "The whole ellipsoid x²/a² + y²/b² + z²/c² = 1 with the longitude u and the latitude v of the sphere that is stretched, poles at z = ±c, and outward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x."),
            "b": (0.6, True, "The semi-axis along y."),
            "c": (0.3, True, "The semi-axis along z."),
        },
        "domain": ((0, 2 * math.pi), (-0.5 * math.pi, 0.5 * math.pi)),
        "boundary": (("periodic", "periodic"), ("pole", "pole")),
    },
    "ellipsoid_patch": {
        "position": ellipsoid_patch,
        "sentence": "The belt of the ellipsoid between the latitudes v = ±π/3, without its poles, with the longitude u and outward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x."),
            "b": (0.6, True, "The semi-axis along y."),
            "c": (0.3, True, "The semi-axis along z."),
        },
        "domain": ((0, 2 * math.pi), (-(1.0 / 3.0) * math.pi, (1.0 / 3.0) * math.pi)),
        "boundary": (("periodic", "periodic"), ("open", "open")),
    },
    "sphere": {
        "position": sphere,
        "sentence": "The whole sphere around the origin, with the longitude u, the latitude v, poles on the z axis, and outward normals.",
        "parameters": {"radius": (1.0, True, "The radius.")},
        "domain": ((0, 2 * math.pi), (-0.5 * math.pi, 0.5 * math.pi)),
        "boundary": (("periodic", "periodic"), ("pole", "pole")),
    },
    "hyperboloid": {
        "position": hyperboloid,
        "sentence": "The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1; u goes around the z axis, v along it. Normals point away from the axis.",
        "parameters": {
            "a": (1.0, True, "The semi-axis of the waist along x."),
            "b": (0.8, True, "The semi-axis of the waist along y."),
            "c": (1.0, True, "The semi-axis along z, imaginary: the waist is at z = 0."),
        },
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "boundary": (("periodic", "periodic"), ("open", "open")),
    },
    "elliptic_paraboloid": {
        "position": elliptic_paraboloid,
        "sentence": "The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to its inside.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x of the ellipse at z = 1."),
            "b": (1.5, True, "The semi-axis along y of the ellipse at z = 1."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "hyperbolic_paraboloid": {
        "position": hyperbolic_paraboloid,
        "sentence": "The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals.",
        "parameters": {
            "a": (1.0, True, "The semi-axis along x of the hyperbola at z = 1."),
            "b": (1.5, True, "The semi-axis along y of the hyperbola at z = −1."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "monkey_saddle": {
        "position": monkey_saddle,
        "sentence": "The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward normals and a flat point at the origin.",
        "parameters": {"scale": (0.5, True, "The factor of the heights.")},
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "enneper": {
        "position": enneper,
        "sentence": "Enneper's minimal surface, without the self-intersections that it has farther out, in conformal parameters, with its normal at the origin pointing upwards.",
        "parameters": {"scale": (1.0, True, "The factor of the size.")},
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "catenoid": {
        "position": catenoid,
        "sentence": "The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius; u is the angle around the z axis, v = z/radius. Normals point away from the axis.",
        "parameters": {"radius": (1.0, True, "The radius of the waist.")},
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "boundary": (("periodic", "periodic"), ("open", "open")),
    },
    "helicoid": {
        "position": helicoid,
        "sentence": "One turn of the right-handed helicoid; u is the signed distance from the z axis, v the angle. Normals point upwards where u > 0 and downwards where u < 0.",
        "parameters": {"pitch": (0.5, True, "The rise per radian.")},
        "domain": ((-1, 1), (-math.pi, math.pi)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "moebius_band": {
        "position": moebius_band,
        "sentence": "The Möbius band around the z axis; u is the angle around the axis, v runs across. It is upright at u = 0, where its normal points away from the axis; after one turn the normal is opposite.",
        "parameters": {
            "radius": (1.0, True, "The radius of the circle in the middle of the band."),
            "half_width": (0.4, True, "Half the width of the band, less than radius."),
        },
        "domain": ((0, 2 * math.pi), (-1, 1)),
        "boundary": (("mirrored", "mirrored"), ("open", "open")),
    },
    "dupin_cyclide": {
        "position": dupin_cyclide,
        "sentence": "The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − x √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.",
        "parameters": {
            "a": (1.0, True, "The semi-axis of the ellipse along x."),
            "b": (0.96, True, "The semi-axis of the ellipse along y, at most a."),
            "d": (0.5, True, "The mean radius of the tube, √(a² − b²) < d < a for a ring."),
        },
        "domain": ((0, 2 * math.pi), (0, 2 * math.pi)),
        "boundary": (("periodic", "periodic"), ("periodic", "periodic")),
    },
    "wavy_graph": {
        "position": wavy_graph,
        "sentence": "The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with upward normals.",
        "parameters": {
            "amplitude": (0.2, False, "The height of the waves."),
            "frequency": (3.0, False, "Radians per unit of length."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
    "cylinder": {
        "position": cylinder,
        "sentence": "The circular cylinder around the z axis; u is the angle, v = z/height. Normals point away from the axis.",
        "parameters": {"radius": (1.0, True, "The radius."), "height": (2.0, True, "The height.")},
        "domain": ((0, 2 * math.pi), (0, 1)),
        "boundary": (("periodic", "periodic"), ("open", "open")),
    },
    "cone": {
        "position": cone,
        "sentence": "The frustum of a circular cone around the z axis, without its apex; u is the angle, v = z/height. Normals point away from the axis.",
        "parameters": {
            "bottom": (1.0, True, "The radius at z = 0."),
            "top": (0.5, True, "The radius at z = height."),
            "height": (1.0, True, "The height."),
        },
        "domain": ((0, 2 * math.pi), (0, 1)),
        "boundary": (("periodic", "periodic"), ("open", "open")),
    },
    "plane": {
        "position": plane,
        "sentence": "The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals.",
        "parameters": {
            "slope_u": (0.0, False, "The slope along x."),
            "slope_v": (0.0, False, "The slope along y."),
        },
        "domain": ((-1, 1), (-1, 1)),
        "boundary": (("open", "open"), ("open", "open")),
    },
}
