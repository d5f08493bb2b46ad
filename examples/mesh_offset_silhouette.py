"""A torus: its mesh, the surface 0.1 outside it, and its outline for an eye far away."""

import gaussmap as gm
import numpy as np

MAJOR, MINOR, DISTANCE, EYE = 1.0, 0.35, 0.1, (1, 2, 3)
torus = gm.surfaces.torus(major=MAJOR, minor=MINOR)
samples = gm.sample(torus, 5_000)
mesh = samples.mesh()
mesh.write("torus.obj")
shell = samples.offset(DISTANCE)
shell_mesh = shell.mesh()
outline = gm.silhouette(torus, direction=EYE, count=500)
print(mesh, shell, f"{len(outline.polylines)} curves of the outline", sep="\n")

# --- Is it true? ---


def distance(points: np.ndarray) -> np.ndarray:
    """Return the distance from the circle in the middle of the torus."""
    x, y, z = points.T
    return np.hypot(np.hypot(x, y) - MAJOR, z)


def area(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def is_closed(triangles: np.ndarray) -> bool:
    """Say whether each edge is one of two triangles, which pass it in opposite directions."""
    sides = {(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    return len(sides) == triangles.size and all((b, a) in sides for a, b in sides)


EPS = 1e-14  # some units in the last place of 1
assert len(mesh.vertices) == len(samples) == len(shell) == 5_000
assert is_closed(mesh.triangles)
assert len(mesh.vertices) - 3 * len(mesh.triangles) // 2 + len(mesh.triangles) == 0  # a torus
assert np.abs(distance(mesh.vertices) - MINOR).max() < EPS
assert np.abs(distance(shell.points) - MINOR - DISTANCE).max() < EPS
assert is_closed(shell_mesh.triangles)
# Fifty vertices and more go round the torus either way, so that edges turn by 2π/50 = 0.126 at
# most on average: areas are smaller by about 0.126²/6 in each direction.
for found, minor in ((mesh, MINOR), (shell_mesh, MINOR + DISTANCE)):
    missing = 1 - area(found.vertices, found.triangles) / (4 * np.pi**2 * MAJOR * minor)
    assert 0 < missing < 0.126**2 / 3

# Points of an outline are found on the quadratic spline that approximates the torus, and moved to
# the torus. The misfit of the spline bounds the move: in half a cell of 2π/64 along u and along v,
# the terms of third order are below (π/64)³/6 of third derivatives.
TERMS = 2 * (np.pi / 64) ** 3 / 6 * (MAJOR + MINOR)
assert np.abs(distance(outline.points) - MINOR).max() <= gm.fit(torus).misfit.distance < TERMS
assert np.abs(outline.normals @ EYE).max() < 1e-12
lines = [outline.points[line] for line in outline.polylines]
assert len(lines) == 2
assert all((line[0] == line[-1]).all() for line in lines)
# The outline is complete: no point with n·EYE = 0, by the formula, is farther from its points than
# the widest gap between neighbours.
turn = np.linspace(0, 2 * np.pi, 1_000)
ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
tilt = np.arctan2(-ring @ EYE, EYE[2])
gap = max(np.linalg.norm(np.diff(line, axis=0), axis=1).max() for line in lines)
for angle in (tilt, tilt + np.pi):
    normal = np.cos(angle)[:, None] * ring + np.sin(angle)[:, None] * [0, 0, 1]
    points = MAJOR * ring + MINOR * normal
    apart = np.linalg.norm(points[:, None] - outline.points, axis=2).min(axis=1)
    assert apart.max() < gap
