"""Parts made of numbers, for tests without Open CASCADE."""

from collections.abc import Iterator
from dataclasses import replace

import gaussmap as gm
import numpy as np
from gaussmap.tools.cad.examples import all_kinds
from gaussmap.tools.cad.part import Part, part_of
from gaussmap.tools.cad.records import EdgeRecord, FaceRecord, Geometry, Net, PartRecord

TURN = 2 * np.pi
UNIT, WHOLE, HALF = (0.0, 1.0), (0.0, TURN), (-TURN / 4, TURN / 4)
# x, y and z of a frame that is neither along the axes nor orthogonal to any of them.
AXES = np.array([[2, 1, -2], [1, 2, 2], [2, -2, 1]]) / 3
BEZIER = (0.0, 0.0, 0.0, 1.0, 1.0, 1.0)
FAILED = FaceRecord(Geometry("unknown"), reason="it has no surface")

# --- faces ----------------------------------------------------------------------------------------

# The domains and periods of whole faces of each kind, and the areas of rectangles of parameters.
DOMAINS = {
    "plane": (UNIT, UNIT, (0.0, 0.0), lambda u, v: u * np.ptp(v)),
    "cylinder": (WHOLE, UNIT, (TURN, 0.0), lambda u, v, r: u * np.ptp(v) * r),
    "cone": (
        WHOLE, UNIT, (TURN, 0.0),
        lambda u, v, r, angle: u * np.ptp(v) * abs(r + np.mean(v) * np.sin(angle)),
    ),
    "sphere": (WHOLE, HALF, (TURN, 0.0), lambda u, v, r: u * np.ptp(np.sin(v)) * r**2),
    "torus": (
        WHOLE, WHOLE, (TURN, TURN),
        lambda u, v, r, tube: u * abs(tube) * (r * np.ptp(v) + tube * np.diff(np.sin(v))[0]),
    ),
}  # fmt: skip


def placement(origin=(0.0, 0.0, 0.0), z=(0.0, 0.0, 1.0), x=(1.0, 0.0, 0.0)) -> np.ndarray:
    """Return the numbers of a frame whose y is z × x."""
    return np.concatenate([origin, x, np.cross(z, x), z]).astype(np.float64)


def face(kind: str, *sizes: float, u=None, v=None, place=None, **more) -> FaceRecord:
    """Return a face over a rectangle of parameters, by default the whole surface at the origin."""
    whole_u, whole_v, periods, area = DOMAINS[kind]
    u, v = whole_u if u is None else u, whole_v if v is None else v
    numbers = np.array([*(placement() if place is None else place), *sizes], np.float64)
    given = {"loops": [rectangle(u, v)], "area": float(area(np.ptp(u), v, *sizes)), **more}
    return FaceRecord(Geometry(kind, numbers), (u, v), periods, **given)


def net(points, weights=None, knots=BEZIER) -> Net:
    """Return a curve, or a surface with the same knots along both parameters."""
    points = np.asarray(points, np.float64)
    count, degree = points.ndim - 1, len(knots) - len(points) - 1
    return Net((degree,) * count, (np.array(knots, np.float64),) * count, points, weights)


def nurbs(points, weights=None, knots=BEZIER) -> Geometry:
    return Geometry("nurbs", net=net(points, weights, knots))


def rectangle(u, v) -> np.ndarray:
    return np.array([(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])])


def circle(radius: float = 1.0, count: int = 1440, start: float = 0.0) -> np.ndarray:
    """Return the corners (count, 2) of a polygon in a circle around the origin."""
    angles = start + np.linspace(0.0, TURN, count, endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


# --- surfaces -------------------------------------------------------------------------------------


def bezier(points, weights=None, **more) -> gm.Surface:
    """Return the surface with these control points (m, n, 3) over the unit square."""
    m, n, _ = np.shape(points)
    knots = [0.0] * m + [1.0] * m, [0.0] * n + [1.0] * n
    return gm.Surface.from_nurbs((m - 1, n - 1), knots, points, weights, **more)


def moved(surface: gm.Surface, shift, scale: float = 1.0) -> gm.Surface:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = shift
    return surface.transformed(matrix)


# --- parts ----------------------------------------------------------------------------------------


def part(faces, name: str = "part", oriented: bool = True, **more) -> Part:
    return part_of(PartRecord(name, "mm", 1e-3, oriented, faces, **more))


def cylinder_faces(radius: float = 1.0, height: float = 2.0) -> list[FaceRecord]:
    """Return the side and the two disks of a cylinder, normals outward."""
    ends, of_one = (-radius, radius), {"solid_index": 0}
    side = face("cylinder", radius, v=(0.0, height), color=(1.0, 0.5, 0.0), **of_one)
    disk = {"loops": [circle(radius)], "area": np.pi * radius**2, **of_one}
    places = {z: placement((0.0, 0.0, z)) for z in (0.0, height)}
    return [side] + [
        face("plane", u=ends, v=ends, place=place, reversed=z == 0.0, **disk)
        for z, place in places.items()
    ]


def side(places, slopes=None):
    """Return u and v (k, 2) of an edge on a face, or places (2, 2) of a straight one; see below."""
    places = np.asarray(places, np.float64)
    straight = np.tile(places[-1:] - places[:1], (len(places), 1))
    return places, straight if slopes is None else slopes


def round_side(radius: float, points: int, start: float = 0.0):
    """Return a circle around the origin as an edge of a plane has it."""
    angles = start + np.linspace(0.0, TURN, points)
    places = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return side(places, TURN * np.stack([-places[:, 1], places[:, 0]], axis=1))


def edge(faces, sides, vertices, degenerate: bool = False) -> EdgeRecord:
    """Return an edge from what `side` returns for each of its faces."""
    places, slopes = (np.concatenate(x, axis=1) for x in zip(*sides, strict=True))
    return EdgeRecord(tuple(faces), places, slopes, vertices, degenerate)


# Around a face that is closed along u: along the low end, up the seam, and back.
AROUND = [(0, 0, False), (2, 1, False), (1, 0, True), (2, 0, True)]


def cylinder(radius: float = 1.0, height: float = 2.0, points: int = 9) -> Part:
    """Return a cylinder with its edges: two circles, of which there are few points, and a seam."""
    u, ends = np.linspace(0.0, TURN, points), enumerate((0.0, height))
    rims = [
        edge((0, k + 1), [side(np.c_[u, np.full(points, z)]), round_side(radius, points)], (k, k))
        for k, z in ends
    ]
    seam = edge((0, 0), [side([(x, 0.0), (x, height)]) for x in WHOLE], (0, 1))
    faces = cylinder_faces(radius, height)
    wires = [AROUND, [(0, 1, False)], [(1, 1, False)]]
    faces = [replace(x, wires=[wire]) for x, wire in zip(faces, wires, strict=True)]
    vertices = np.array([(radius, 0.0, 0.0), (radius, 0.0, height)])
    return part(faces, "cylinder", edges=[*rims, seam], vertices=vertices, solid_names=["one"])


def ball(radius: float = 1.0) -> Part:
    """Return a ball with its edges: a seam, and a degenerate one at each pole."""
    poles = [edge((0,), [side([(u, v) for u in WHOLE])], (k, k), True) for k, v in enumerate(HALF)]
    seam = edge((0, 0), [side([(u, v) for v in HALF]) for u in WHOLE], (0, 1))
    whole = face("sphere", radius, solid_index=0, wires=[AROUND])
    vertices = np.array([(0.0, 0.0, -radius), (0.0, 0.0, radius)])
    return part([whole], "ball", edges=[*poles, seam], vertices=vertices, solid_names=["one"])


# Parts that no test changes: what is found out about their faces is kept with them.
KINDS, CYLINDER = all_kinds(), cylinder()

# --- what is measured -----------------------------------------------------------------------------


def normals_of(jets: np.ndarray) -> np.ndarray:
    """Return the unit normals (k, 3) of derivatives (k, 3 or more, 3)."""
    normals = np.cross(jets[:, 1], jets[:, 2])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def is_on(surface, uv, points, normals, *, of_normals: float = 1e-13) -> None:
    """Check that points and normals are those of a surface at its parameters."""
    jets = surface.jets(*uv.reshape(-1, 2).T.copy())
    np.testing.assert_allclose(jets[:, 0], points.reshape(-1, 3), atol=1e-15)
    np.testing.assert_allclose(normals_of(jets), normals.reshape(-1, 3), atol=of_normals)


def has_its_dimensions(alone: Part) -> None:
    """Check points and normals of the only face of a part against its dimensions."""
    (known,) = alone.faces
    kind, samples, known = known.kind, gm.sample(alone, 50), known.dimensions
    points, normals = samples.points, samples.normals
    if kind == "plane":
        assert np.allclose(normals, known["normal"], atol=1e-14)
        assert np.allclose((points - known["point"]) @ known["normal"], 0.0, atol=1e-14)
        return
    (centre,) = (known[x] for x in ("point", "apex", "centre") if x in known)
    across = points - centre
    height = across @ known.get("axis", np.zeros(3))
    radial = across - height[:, None] * known.get("axis", np.zeros(3))
    distance = np.linalg.norm(radial, axis=1)
    if kind == "cone":
        assert np.allclose(distance, height * np.tan(np.radians(known["half_angle"])), atol=1e-13)
        assert (height > 0.0).all()
    elif kind == "torus":
        radial *= (1.0 - known["major_radius"] / distance)[:, None]
        radial += height[:, None] * known["axis"]
        assert np.allclose(np.linalg.norm(radial, axis=1), known["minor_radius"], atol=1e-14)
    else:
        assert np.allclose(distance, known["radius"], atol=1e-14)
    inward = np.einsum("ij,ij->i", radial, normals) < 0.0
    assert inward.all() if known["hollow"] else not inward.any()


def face_normals(mesh) -> np.ndarray:
    """Return the normals (k, 3) of triangles, whose lengths are their areas."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2.0


def noted(monkeypatch, owner, name: str, what) -> list:
    """Return a list to which each call of a function appends `what` of its arguments and result."""
    found, call = [], getattr(owner, name)

    def noting(*given):
        result = call(*given)
        result = [*result] if isinstance(result, Iterator) else result
        found.append(what(given, result))
        return result

    monkeypatch.setattr(owner, name, noting)
    return found
