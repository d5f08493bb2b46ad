# %% [markdown]
# # Data sets for learning: points with exact normals and curvatures
#
# A network that estimates normals or curvatures from points needs points whose normals and
# curvatures are known. gaussmap computes them in closed form, not from differences of neighbours.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import KDTree

# %% [markdown]
# ## Many shapes, one call
#
# Twelve random tori and ellipsoids. `sample_many` samples them one after the other; `fields` are
# the arrays to compute, and `dtype` halves the memory. The arguments are those of `gm.sample`.

# %%
rng = np.random.default_rng(1)
shapes = [gm.surfaces.torus(major=1, minor=r) for r in rng.uniform(0.2, 0.6, 6)]
shapes += [gm.surfaces.ellipsoid(a=a, b=b, c=1) for a, b in rng.uniform(0.6, 1.8, (6, 2))]

fields = ("points", "normals", "gaussian_curvature", "mean_curvature")
clouds = list(
    gm.sample_many(
        shapes, count=2000, density="uniform", fields=fields, dtype=np.float32, progress=False
    )
)
print(len(clouds), "clouds, the first one with", clouds[0].points.shape, clouds[0].points.dtype)

# %% [markdown]
# The same as a table of pandas:

# %%
table = clouds[0].to_dataframe()
print(table.describe().loc[["count", "mean", "min", "max"]].round(3).T)

# %% [markdown]
# ## Progressive order: one sampling, all sizes
#
# Samples come in the order of their normals, so that the first rows are from a part of the surface.
# After `progressive()` every prefix is well distributed: the first 100 rows, and the first 500.

# %%
samples = gm.sample(gm.surfaces.torus(), count=4000)
ordered = samples.progressive()

figure, axes = plt.subplots(1, 3, figsize=(9, 3), dpi=65, layout="constrained")
for axis, (rows, title) in zip(
    axes,
    (
        (samples[:500], "first 500 as they come"),
        (ordered[:100], "first 100, progressive"),
        (ordered[:500], "first 500, progressive"),
    ),
    strict=True,
):
    front = rows.normals[:, 2] > 0
    axis.scatter(
        *rows.points[front][:, :2].T, s=4, c=rows.gaussian_curvature[front], cmap="coolwarm"
    )
    axis.set(title=title, aspect="equal", xlim=(-1.45, 1.45), ylim=(-1.45, 1.45))
plt.show()

# %% [markdown]
# So clouds of the same size, for a batch, are prefixes of clouds in progressive order.

# %%
batch = np.stack([cloud.progressive().points[:1024] for cloud in clouds])
print(batch.shape, batch.dtype)

# %% [markdown]
# ## Weights: means over the area
#
# Samples are dense where the curvature is large, so that their mean is not the mean over the area.
# `weights()` is the area that belongs to each sample. Use it in a loss, too.
#
# On a torus of radii 1 and r the mean of K over the area is 0, and that of H is 1/(2r).

# %%
weights = samples.weights()
r = 0.35
for name, f, truth in (
    ("K", samples.gaussian_curvature, 0.0),
    ("H", samples.mean_curvature, 1 / (2 * r)),
):
    plain, weighted = f.mean(), np.average(f, weights=weights)
    print(f"mean {name}: plain {plain:7.4f}, weighted {weighted:7.4f}, true {truth:7.4f}")
print(f"area: {weights.sum():.5f}, true {4 * np.pi**2 * r:.5f}")

# %% [markdown]
# ## A test for an estimator
#
# The classical estimate of a normal: fit a plane to the nearest neighbours. How large is its error?
# Here the true normals are known, so that it can be measured.


# %%
def fitted_normals(points, neighbours):
    _, rows = KDTree(points).query(points, neighbours)
    near = points[rows] - points[rows].mean(axis=1, keepdims=True)
    return np.linalg.svd(near, full_matrices=False)[2][:, 2]


noisy = samples.points + rng.normal(0, 0.003, samples.points.shape)
for neighbours in (8, 16, 32, 64):
    cosines = np.abs((fitted_normals(noisy, neighbours) * samples.normals).sum(axis=1))
    error = np.degrees(np.arccos(np.minimum(cosines, 1)))
    mean = np.average(error, weights=weights)
    print(f"{neighbours:2} neighbours: {mean:5.2f}° on average over the area")

# %% [markdown]
# ## Storing it
#
# An .npz file holds all arrays and the report; `gm.read_samples` reads it again.

# %%
ordered.write("torus.npz")
again = gm.read_samples("torus.npz")
assert (again.points == ordered.points).all()
print(again.summary())
