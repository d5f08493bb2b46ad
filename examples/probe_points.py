"""Where to probe an asphere: 300 points with normals, and the largest normal deviation."""

import gaussmap as gm
import numpy as np

# An even asphere in mm: its sag is z(r), with radius R, conic constant k and two coefficients.
R, k, A4, A6, APERTURE = 20.0, -0.6, 2e-5, -1e-8, 10.0
SAG = f"r**2/({R}*(1 + sqrt(1 - {1 + k}*r**2/{R**2}))) + {A4}*r**4 + {A6}*r**6"

asphere = gm.Surface.from_sympy(
    ("r*cos(t)", "r*sin(t)", SAG),
    ("r", "t"),
    domain=((0, APERTURE), (0, "2*pi")),
    periodic=(False, True),
    name="asphere",
)
probes = gm.sample(asphere, 300)
deviation = probes.normal_deviation()
probes.write("probes.csv")
print(f"{len(probes)} points; every normal is within {deviation.normal_space:.2f}° of that of")
print(f"a point, and {deviation.space:.2f}° of that of the nearest point")

# --- Is it true? Points by the equation, normals by its derivative, angles on a fine grid. ---


def sag(r: np.ndarray) -> np.ndarray:
    return r**2 / (R * (1 + np.sqrt(1 - (1 + k) * r**2 / R**2))) + A4 * r**4 + A6 * r**6


def slope(r: np.ndarray) -> np.ndarray:
    return r / np.sqrt(R**2 - (1 + k) * r**2) + 4 * A4 * r**3 + 6 * A6 * r**5


def normals_at(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    r = np.hypot(x, y)
    turn = np.arctan2(y, x)
    up = np.stack([-slope(r) * np.cos(turn), -slope(r) * np.sin(turn), np.ones_like(r)], axis=-1)
    return up / np.linalg.norm(up, axis=-1, keepdims=True)


assert len(probes) == 300
x, y, z = probes.points.T
assert np.hypot(x, y).max() <= APERTURE * (1 + 1e-14)
assert np.abs(z - sag(np.hypot(x, y))).max() < 1e-13  # some units in the last place of 10 mm
side = np.sign(probes.normals[0, 2])
assert np.abs(probes.normals - side * normals_at(x, y)).max() < 1e-12
rows = np.loadtxt("probes.csv", delimiter=",", skiprows=1)
assert len(rows) == 300

STEP = (
    0.1  # mm, and mm of arc at the border: no place is farther than half a diagonal from the grid
)
r, t = np.meshgrid(np.linspace(0, APERTURE, 101), np.linspace(0, 2 * np.pi, 629), indexing="ij")
x, y = (r * np.cos(t)).ravel(), (r * np.sin(t)).ravel()
grid, grid_normals = np.stack([x, y, sag(np.hypot(x, y))], axis=1), side * normals_at(x, y)
cosines = np.clip(grid_normals @ probes.normals.T, -1, 1)
by_normal = np.degrees(np.arccos(cosines.max(axis=1))).max()
nearest = np.linalg.norm(grid[:, None] - probes.points, axis=2).argmin(axis=1)
by_place = np.degrees(np.arccos(cosines[np.arange(len(grid)), nearest])).max()
turning = np.degrees(STEP / np.sqrt(2) * 1.1 / R)  # of the normal in half a diagonal, κ < 1.1/R
assert abs(deviation.normal_space - by_normal) < turning, (deviation, by_normal)
# The nearest point changes between two places of the grid, so that this angle can jump.
assert abs(deviation.space - by_place) < 2 * turning, (deviation, by_place)
