# %% [markdown]
# # Teaching: the Gauss map, seen
#
# Each point of a smooth surface has a unit normal. Take that normal as a point of the unit sphere:
# this is the **Gauss map**, from the surface to the sphere. gaussmap goes the other way. It is
# given a normal and finds *all* points that have it.

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
# inside, where K < 0. That is so for every normal but ±(0, 0, 1), which all points of the top
# circle share.

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
# The outside covers the whole sphere, and so does the inside. Where normals are spread evenly, the
# points are as dense as |K|: this is what K means. A small piece of area dA has normals that fill
# |K| dA of the sphere.

# %% [markdown]
# ## Gauss and Bonnet
#
# So the integral of K over a closed surface counts how often the sphere is covered, with a sign. It
# is 2π times the Euler characteristic χ, whatever the shape is. `weights()` are the dA of the
# samples.

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
# There is a version without any integral: for every normal the signs of K at the points that have
# it sum up to half the Euler characteristic.

# %%
normals = gm.fibonacci(1000)
found = gm.sample(torus, normals=normals)
signs = np.bincount(found.normal_index, np.sign(found.gaussian_curvature), len(normals))
assert (signs == 0).all()
print("0 for each of the", len(normals), "normals")

# %% [markdown]
# ## Parabolic curves
#
# Between K > 0 and K < 0 there are curves with K = 0. The waves below have many. gaussmap follows
# them. At these curves the Gauss map folds: on both sides of the curve are points with the same
# normals.

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
# surface can be found from it, as the envelope of its tangent planes: the point is the gradient of
# h. For the ellipsoid with half axes 2, 1, 1 that is

# %%
ellipsoid = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")
n = np.array([1, 2, 2]) / 3
point = ellipsoid.envelope([n])[0]
print("point", point, "on the ellipsoid:", point @ (point / [4, 1, 1]))

# %% [markdown]
# Offsets and sums are simple on support functions: one adds them. A ball of radius 0.3 has h = 0.3.

# %%
ball = gm.SupportFunction.from_sympy("3*sqrt(n_x**2 + n_y**2 + n_z**2)/10")
np.testing.assert_allclose((ellipsoid + ball).envelope([n])[0], point + 0.3 * n)
print((ellipsoid + ball).expression)

# %% [markdown]
# ## Silhouettes
#
# One sees the outline of a surface where the normal is perpendicular to the direction of view: the
# normals form a great circle. Each piece of the sphere has its points; so does this circle.

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
