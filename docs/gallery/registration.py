# %% [markdown]
# # Registration: which points determine the position of a part
#
# A scanner has measured a part: a cloud of noisy points, somewhere in space. Where does the part
# lie? *ICP* (iterative closest points) finds out: it takes points of the known part, searches the
# nearest scanned point of each, moves the part towards them, and repeats this.
#
# On a smooth part most points contribute little. If a plate slides along itself, the distances of
# points on its flat area do not change. Only those of points on small features do. Does it help to
# choose these?

# %%
import warnings

import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

warnings.simplefilter("ignore", gm.GaussmapWarning)  # "part of it is flat": yes, it is

# %% [markdown]
# The part: a plate of 100 × 100 mm, gently curved, with two bumps and a dent 1 mm high.


# %%
def plate(u, v, height=1.0):
    z = -(u**2 + v**2) / 2000
    for x, y, sign in ((-30, 22, 1), (12, -33, -1), (35, 10, 1)):
        z = z + sign * height * np.exp(-((u - x) ** 2 + (v - y) ** 2) / 18)
    return np.stack([u, v, z], axis=-1)


square = ((-50, 50), (-50, 50))
part = gm.Surface.from_callable(plate, square, name="plate")

# %% [markdown]
# Three ways to choose 300 points, which differ in nothing but `density`:
#
# - "uniform": the same density everywhere;
# - "gauss": the points with normals that are uniform on the sphere, *normal-space sampling*;
# - "balanced": the same with fewer normals, and points that fill the gaps.

# %%
COUNT = 300
DENSITIES = ("uniform", "gauss", "balanced")
chosen = {x: gm.sample(part, count=COUNT, density=x, cells=(128, 128)) for x in DENSITIES}

figure, axes = plt.subplots(1, 3, figsize=(9, 3.2), dpi=65, layout="constrained")
for axis, (name, samples) in zip(axes, chosen.items(), strict=True):
    axis.scatter(*samples.points[:, :2].T, s=3)
    axis.set(title=f"{name}: {len(samples)}", aspect="equal", xlim=(-52, 52), ylim=(-52, 52))
plt.show()

# %% [markdown]
# ## The scan, and the start
#
# The scan has 40,000 points with noise of 0.05 mm. The part starts turned by 1 degree about a
# random axis, and moved by up to 1 mm along each axis. The true position is the identity.


# %%
def scan(rng, height=1.0):
    u, v = rng.uniform(-50, 50, (2, 40_000))
    points = plate(u, v, height)
    return points + rng.normal(0, 0.05, points.shape)


def start(rng):
    axis = rng.normal(size=3)
    turn = Rotation.from_rotvec(np.radians(1) * axis / np.linalg.norm(axis))
    return turn, rng.uniform(-1, 1, 3) * [1, 1, 0.5]


# %% [markdown]
# ## Point-to-plane ICP
#
# This is the textbook's, in a few lines. For each sample p with normal n, the nearest scanned point
# q should lie in its tangent plane: n·(p − q) = 0. A small rotation w and translation t change that
# by n·(w × p + t), which gives linear equations for w and t. Points that are farther than 10 mm
# from the scan are left out.


# %%
def icp(samples, tree, turn, shift, steps=60):
    for _ in range(steps):
        points, normals = turn.apply(samples.points) + shift, turn.apply(samples.normals)
        distances, nearest = tree.query(points, distance_upper_bound=10)
        near = np.isfinite(distances)
        p, n, q = points[near], normals[near], tree.data[nearest[near]]
        equations = np.hstack([np.cross(p, n), n])
        motion = np.linalg.lstsq(equations, (n * (q - p)).sum(axis=1), rcond=None)[0]
        small = Rotation.from_rotvec(motion[:3])
        turn, shift = small * turn, small.apply(shift) + motion[3:]
        if np.abs(motion).max() < 1e-7:
            break
    return turn, shift


# %% [markdown]
# Twenty scans, each with its own initial position, the same for all three sets of points. The error
# is the remaining rotation and translation. A run has failed if points of the part are more than
# 0.5 mm from their true positions on average.


# %%
def compare(sets, height=1.0, runs=20):
    u, v = np.random.default_rng(0).uniform(-50, 50, (2, 1000))
    places = plate(u, v, height)
    found = {name: [] for name in sets}
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        tree, first = KDTree(scan(rng, height)), start(rng)
        for name, samples in sets.items():
            turn, shift = icp(samples, tree, *first)
            off = np.linalg.norm(turn.apply(places) + shift - places, axis=1).mean()
            found[name].append((np.degrees(turn.magnitude()), np.linalg.norm(shift), off))
    print("           turn / degrees   shift / mm      failed")
    print("           median   90 %    median   90 %")
    for name, errors in found.items():
        turns, shifts, offs = np.transpose(errors)
        numbers = [np.quantile(x, q) for x in (turns, shifts) for q in (0.5, 0.9)]
        failed = f"{(offs > 0.5).sum()} of {runs}"
        print(f"{name:10}", *(f"{x:7.3f}" for x in numbers), f"   {failed}")
    return found


errors = compare(chosen)

# %% [markdown]
# With points on the features, both sliding and rotation about the vertical axis are smaller. In the
# picture each dot is one run.

# %%
figure, axis = plt.subplots(figsize=(5, 3), dpi=65, layout="constrained")
for name, runs in errors.items():
    turns, shifts, _ = np.transpose(runs)
    axis.loglog(turns, shifts, ".", label=name)
axis.set(xlabel="turn / degrees", ylabel="shift / mm", title="what is left, 20 runs each")
axis.legend()
plt.show()

# %% [markdown]
# ## Where it does not help
#
# **Many points.** With 10,000 points each feature has enough of them anyway. The remaining error is
# due to the noise of the scan, and the choice of points hardly matters.

# %%
many = {x: gm.sample(part, count=10_000, density=x, cells=(128, 128)) for x in DENSITIES}
_ = compare(many, runs=6)

# %% [markdown]
# **No features.** A plate without bumps slides and turns until its points leave the scan: nothing
# determines its position, and no choice of points changes that.

# %%
smooth = gm.Surface.from_callable(lambda u, v: plate(u, v, 0.0), square, name="smooth plate")
_ = compare({x: gm.sample(smooth, count=COUNT, density=x) for x in DENSITIES}, 0.0, runs=6)

# %% [markdown]
# **A bad start.** If the initial error is larger than a feature, ICP does not find the feature.
# Then uniform points are better. The [guide](../guides/registration.md#measured) has figures for
# more numbers of points, with the ICP of Open3D.
