# %% [markdown]
# # Teaching: the Gauss map in pictures
#
# Each point of a smooth surface has a unit normal. Take that normal as a point of the unit sphere:
# this is the **Gauss map**, from the surface to the sphere. gaussmap computes its inverse: *all*
# points that have a given normal.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %%
torus = gm.surfaces.torus(major=1, minor=0.35)
one = gm.sample(torus, normals=[[1, 2, 2]])
for point, K in zip(one.points, one.gaussian_curvature, strict=True):
    print(f"x = {point.round(3)}, K = {K:.2f}")

# %% [markdown]
# Two points of a torus have the normal (1, 2, 2)/3: one on the outside, where K > 0, one on the
# inside, where K < 0. That is so for every normal except ±(0, 0, 1), the normals of all points of
# the top and the bottom circle.

# %%
samples = gm.sample(torus, count=1500, density="gauss")
limit = np.abs(samples.gaussian_curvature).max() / 3


def show(axis, xyz, samples, title):
    axis.scatter(
        *xyz.T, s=3, c=samples.gaussian_curvature, cmap="coolwarm", vmin=-limit, vmax=limit
    )
    axis.set_title(title)
    axis.set_box_aspect(np.ptp(xyz, axis=0))
    axis.set_axis_off()


figure, axes = plt.subplots(
    1, 3, figsize=(9, 3.2), dpi=65, subplot_kw={"projection": "3d"}, layout="constrained"
)
show(axes[0], samples.points, samples, "samples")
for axis, part, title in (
    (axes[1], samples[samples.elliptic], "normals where K > 0"),
    (axes[2], samples[samples.hyperbolic], "normals where K < 0"),
):
    show(axis, part.normals, part, title)
plt.show()

# %% [markdown]
# The outside covers the whole sphere, and so does the inside. If the normals are uniform, the
# density of the points is proportional to |K|, which is the meaning of K: the normals of an element
# of area dA fill the area |K| dA of the sphere.

# %% [markdown]
# ## Gauss and Bonnet
#
# So the integral of K over a closed surface is 4π times the number of times that the sphere is
# covered, with signs. It is 2π times the Euler characteristic χ, for each shape. `weights()` are
# the dA of the samples.

# %%
for surface, euler in (
    (torus, 0),
    (gm.surfaces.torus(major=1, minor=0.7), 0),
    (gm.surfaces.ellipsoid(a=2, b=1, c=1.5), 2),
):
    found = gm.sample(surface, count=5000, density="uniform")
    total = (found.weights() * found.gaussian_curvature).sum()
    print(f"{surface.name:10} ∫ K dA / 2π = {total / (2 * np.pi):7.4f}, χ = {euler}")

# %% [markdown]
# There is a version without an integral: for every normal, the sum of the signs of K at the points
# with this normal is half the Euler characteristic.

# %%
normals = gm.fibonacci(1000)
found = gm.sample(torus, normals=normals)
signs = np.bincount(found.normal_index, np.copysign(1, found.gaussian_curvature), len(normals))
assert (signs == 0).all()
print("0 for each of the", len(normals), "normals")

# %% [markdown]
# ## Parabolic curves
#
# Between regions with K > 0 and K < 0 there are curves with K = 0. The waves below have many, which
# gaussmap computes. At these curves the Gauss map folds: points on both sides of the curve have the
# same normals.

# %%
waves = gm.surfaces.wavy_graph()
parabolic = gm.gauss_map.parabolic_points(waves)
samples = gm.sample(waves, count=2000, density="uniform")

figure, axes = plt.subplots(1, 2, figsize=(8, 3.8), dpi=65, layout="constrained")
limit = np.abs(samples.gaussian_curvature).max()
look = {"s": 5, "c": samples.gaussian_curvature, "cmap": "coolwarm", "vmin": -limit, "vmax": limit}
axes[0].scatter(*samples.points[:, :2].T, **look)
axes[1].scatter(*samples.normals[:, :2].T, **look)
spline = gm.fit(waves)
for curve in parabolic.curves:
    axes[0].plot(*curve.points[:, :2].T, color="black", linewidth=1)
    normals = spline.normals(*curve.uv.T)
    axes[1].plot(*normals[:, :2].T, color="black", linewidth=1)
axes[0].set(title="the surface from above", aspect="equal")
axes[1].set(title="its normals from above", aspect="equal")
plt.show()

# %% [markdown]
# ## The support function
#
# The tangent plane with normal n has a distance h(n) from the origin: the **support function**. The
# surface is the envelope of its tangent planes: the point with normal n is the gradient of h. For
# the ellipsoid with semi-axes 2, 1, 1, h is

# %%
ellipsoid = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")
n = np.array([1, 2, 2]) / 3
point = ellipsoid.envelope([n])[0]
print("point", point, "on the ellipsoid:", point @ (point / [4, 1, 1]))

# %% [markdown]
# For offsets and Minkowski sums, support functions are added. A ball of radius 0.3 has h = 0.3.

# %%
ball = gm.SupportFunction.from_sympy("3*sqrt(n_x**2 + n_y**2 + n_z**2)/10")
np.testing.assert_allclose((ellipsoid + ball).envelope([n])[0], point + 0.3 * n)
print((ellipsoid + ball).expression)

# %% [markdown]
# ## Silhouettes
#
# The outline of a surface consists of points whose normals are perpendicular to the direction of
# view. These normals form a great circle, and gaussmap computes the points that have them.

# %%
direction = np.array([1, 0.4, 0.7])
outline = gm.silhouette(torus, direction, count=1500)
right = np.cross([0, 0, 1], direction)
up = np.cross(direction, right)
screen = np.stack([right / np.linalg.norm(right), up / np.linalg.norm(up)])

figure, axis = plt.subplots(figsize=(4.5, 3.2), dpi=65, layout="constrained")
cloud = gm.sample(torus, count=3000, density="uniform", fields=("points",)).points @ screen.T
axis.scatter(*cloud.T, s=1, color="0.8")
for part, colour, label in (
    (outline.elliptic, "tab:red", "convex (K > 0)"),
    (outline.hyperbolic, "tab:blue", "concave (K < 0)"),
):
    axis.scatter(*(outline.points[part] @ screen.T).T, s=2, color=colour, label=label)
axis.set_aspect("equal")
axis.set_axis_off()
figure.legend(fontsize=8, loc="outside lower center", ncols=2)
plt.show()
