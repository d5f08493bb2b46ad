"""Surfaces for tests of several folders: closed ones outside the catalogue, and moved ones."""

from collections.abc import Iterable
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.runtime.samples.report import SamplingReport
from numpy.typing import NDArray
from scipy.spatial import KDTree

Array = NDArray[np.float64]
EPS = 2.0**-52
AXES = np.concatenate([np.eye(3), -np.eye(3)])
TORUS = gm.surfaces.torus(major=1.0, minor=0.35)
SQUARE = ((0.0, 1.0), (0.0, 1.0))
FIELDS = (
    "points", "normals", "uv", "support", "gaussian_curvature", "mean_curvature", "normal_index",
    "patch_index",
)  # fmt: skip
TURN = (0.0, 2.0 * np.pi)
LATITUDES = (-np.pi / 2, np.pi / 2)


def on_sphere(u: Any, v: Any) -> tuple[Any, Any, Any]:
    u, v = np.broadcast_arrays(u, v)
    return np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)


def egg(u: Any, v: Any) -> Any:
    """Return points of a smooth convex surface whose parameter lines are no circles."""
    x, y, z = on_sphere(u, v)
    return np.stack([x * (1.2 + 0.3 * z), y * (0.8 + 0.1 * z), 1.4 * z + 0.3 * x**2], axis=-1)


def egg_surface() -> gm.Surface:
    return gm.Surface.from_callable(egg, (TURN, LATITUDES), periodic=(True, "pole"), name="egg")


def saddle(u: Any, v: Any) -> Any:
    return np.stack([u, v, u * v + u * u], axis=-1)


def tube(u: Any, v: Any) -> Any:
    """Return points of the torus of radii 2 and 1."""
    return np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)


def klein(u: Any, v: Any) -> Any:
    """Return points of the figure-8 Klein bottle: v is mirrored after a turn of u."""
    ring = 2.0 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    height = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), height], axis=-1)


def torus_samples(count: int, minor: float = 1.0, scale: float = 1.0, **changes: Any) -> gm.Samples:
    """Return samples of the torus of radii 2 and `minor`, times `scale`, from its closed form.

    The outer half is elliptic; the normals do not depend on `minor` and `scale`.
    """
    u, v = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, (2, count))
    normals, circle = np.stack(on_sphere(u, v), axis=1), np.stack(on_sphere(u, 0.0), axis=1)
    points = scale * (2.0 * circle + minor * normals)
    along, across = 1.0 / minor, np.cos(v) / (2.0 + minor * np.cos(v))
    arrays: dict[str, Any] = {
        "points": points,
        "normals": normals,
        "uv": np.stack([u, v], axis=1),
        "support": np.einsum("ij,ij->i", points, normals),
        "gaussian_curvature": along * across / scale**2,
        "mean_curvature": (along + across) / 2.0 / scale,
        "normal_index": np.arange(count),
        "patch_index": np.arange(count) // 4,
        "report": SamplingReport("torus", 8, 12, 4, 0.125, 1),
    }
    return gm.Samples(**(arrays | changes))


def klein_bottle() -> gm.Surface:
    return gm.Surface.from_callable(klein, (TURN, (-np.pi, np.pi)), periodic=("mirrored", True))


def moved(
    surface: gm.Surface, factor: float = 1.0, shift: float = 0.0, rotation: Any = None
) -> gm.Surface:
    """Return a surface that is turned, scaled, and then translated by `shift` along each axis."""

    def evaluate(u: Any, v: Any) -> Any:
        points = surface.evaluate(u, v)
        return factor * (points if rotation is None else points @ rotation.T) + shift

    return gm.Surface(surface.name, evaluate, surface.domain, surface.boundary)


def broken(u: Any, v: Any) -> Any:
    raise RuntimeError("no such surface")


# The position of a torus whose tube has waves.
MINOR = "(7/20 + 3/50*sin(4*u + 3*v))"
KNOBBY = (f"(1 + {MINOR}*cos(v))*cos(u)", f"(1 + {MINOR}*cos(v))*sin(u)", f"{MINOR}*sin(v)")
BROKEN = gm.Surface.from_callable(broken, SQUARE, name="broken")
# Control points and weights of a circle of four conics.
CIRCLE = np.array(
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], np.float64
)
WEIGHTS = np.array([1.0, np.sqrt(0.5)] * 4 + [1.0])
MERIDIAN, HALF = CIRCLE[[6, 7, 0, 1, 2]], WEIGHTS[:5]


def bezier(degree: int, count: int) -> Any:
    """Return the knots, over 0, 1, …, of joined Bézier curves with `count` control points."""
    spans = (count - 1) // degree
    return np.repeat(np.arange(spans + 1.0), [degree + 1, *[degree] * (spans - 1), degree + 1])


def conics(points: Any) -> Any:
    return bezier(2, len(points))


def revolved(
    profile: Any, weights: Any, scales: Any = 1.0, shift: Any = 0.0, **named: Any
) -> gm.Surface:
    """Return conics (r, z) that go round the z axis as u, scaled and translated, as a NURBS."""
    points = np.array([[(r * x, r * y, z) for r, z in profile] for x, y in CIRCLE])
    knots = conics(CIRCLE), conics(profile)
    return gm.Surface.from_nurbs(
        (2, 2), knots, scales * points + shift, np.outer(WEIGHTS, weights), **named
    )


def same(one: gm.Samples, other: gm.Samples) -> None:
    """Check that two samplings have the same fields, bit for bit."""
    assert one.fields == other.fields
    for name, array in one.arrays().items():
        found = getattr(other, name)
        assert (found.dtype, found.tobytes()) == (array.dtype, array.tobytes()), name


def same_chunks(chunks: Iterable[gm.Samples], whole: gm.Samples, size: int) -> None:
    """Check that all chunks but the last are full, and that they make the whole."""
    parts = list(chunks)
    assert [len(x) for x in parts[:-1]] == [size] * (len(parts) - 1)
    assert 0 < len(parts[-1]) <= size
    joined = gm.Samples.concatenate(parts)
    same(joined, whole)
    for name in ("on", "unrefined", "undecided", "developable_share", "normals", "samples"):
        assert getattr(joined.report, name) == getattr(whole.report, name)


def random_rotation(seed: int) -> Any:
    """Return the matrix (3, 3) of a random rotation."""
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return turn * np.sign(np.linalg.det(turn))


def circle(count: int, centre: Any, radius: float) -> Any:
    """Return the corners (count, 2) of a regular polygon in a circle."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def unit(vectors: Any) -> Any:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def normals_at(surface: gm.Surface, uv: Any) -> Any:
    """Return the unit normals (k, 3) of a surface at parameters (k, 2)."""
    jets = surface.derivatives(*uv.T)
    return unit(np.cross(jets[:, 1], jets[:, 2]))


def farthest(samples: gm.Samples, points: Any) -> float:
    """Return the largest distance from one of `points` to the nearest sample."""
    return KDTree(samples.points).query(points)[0].max()


def widest_angle(samples: gm.Samples, normals: Any) -> float:
    """Return the largest angle in degrees from one of `normals` to the nearest sample's."""
    return float(np.degrees(2.0 * np.arcsin(KDTree(samples.normals).query(normals)[0].max() / 2.0)))


def area_of(surface: gm.Surface, side: int = 400) -> float:
    """Estimate the area inside the trim from side × side jittered parameters."""
    (u0, u1), (v0, v1) = surface.domain
    cells = np.stack(np.meshgrid(*[np.arange(side)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    parts = (cells + np.random.default_rng(3).random(cells.shape)) / side
    uv = np.array([u0, v0]) + parts * (u1 - u0, v1 - v0)
    uv = uv if surface.trim is None else uv[surface.trim.contains(uv)]
    jets = surface.jets(*np.ascontiguousarray(uv.T))
    lengths = np.linalg.norm(np.cross(jets[:, 1], jets[:, 2]), axis=1)
    return float(lengths.sum()) * (u1 - u0) * (v1 - v0) / side**2


def central_differences(f: Any, u: Any, v: Any, h: float) -> Any:
    """Return the point and its derivatives by u, v, uu, uv, vv (k, 6, 3), of order 8 in h."""
    first = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5])
    first = np.concatenate([first, [0.0], -first[::-1]]) / h
    second = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5])
    second = np.concatenate([second, [-205 / 72], second[::-1]]) / h**2
    at = np.eye(9)[4]
    steps = h * np.arange(-4, 5)
    points = f(u[:, None, None] + steps[:, None], v[:, None, None] + steps)
    weights = [(at, at), (first, at), (at, first), (second, at), (first, first), (at, second)]
    return np.stack([np.einsum("i,j,kijx->kx", *x, points) for x in weights], axis=1)


def quotients(sums: list[Any]) -> Any:
    """Return x, x_s, x_t, x_ss, x_st, x_tt (6, k, 3) from those of (x w, w)."""
    point, w = [x[:, :3] for x in sums], [x[:, 3:] for x in sums]
    x = point[0] / w[0]
    x_s, x_t = ((point[k] - w[k] * x) / w[0] for k in (1, 2))
    x_ss = (point[3] - 2.0 * w[1] * x_s - w[3] * x) / w[0]
    x_st = (point[4] - w[1] * x_t - w[2] * x_s - w[4] * x) / w[0]
    x_tt = (point[5] - 2.0 * w[2] * x_t - w[5] * x) / w[0]
    return np.stack([x, x_s, x_t, x_ss, x_st, x_tt])


CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def square(**changes: Any) -> gm.Mesh:
    """Two triangles of the unit square, the normals 0, 30, 45 and 60 degrees from its own."""
    angles = np.radians([0, 30, 45, 60])
    arrays: dict[str, Any] = {
        "vertices": CORNERS,
        "normals": np.stack([np.sin(angles), np.zeros(4), np.cos(angles)], axis=1),
        "uv": CORNERS[:, :2] / 3,
        "triangles": np.array([[0, 1, 2], [0, 2, 3]]),
        "sample_index": np.array([5, 6, 7, -1]),
    }
    return gm.Mesh(**(arrays | changes))
