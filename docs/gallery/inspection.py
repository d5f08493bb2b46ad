# %% [markdown]
# # Inspection: where a probe should touch a part
#
# A coordinate measuring machine touches a part at chosen points and compares them with the drawing.
# It needs two things for each point: the place, and the **normal**, along which it approaches.
# gaussmap gives both, with more points where the curvature is larger.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# The part is a lid, 80 × 60 mm, with a rounded rib across it. Any function of two arrays `u`, `v`
# that returns points of shape (…, 3) is a surface.


# %%
def lid(u, v):
    crown = 4.0 * (1 - (u / 40) ** 2) * (1 - (v / 30) ** 2)
    rib = 3.0 * np.exp(-(((u - 0.3 * v) / 4) ** 2))
    return np.stack([u, v, crown + rib], axis=-1)


part = gm.Surface.from_callable(lid, domain=((-40, 40), (-30, 30)), name="lid")

# %% [markdown]
# ## How many points?
#
# There are three ways to prescribe it. The first one is a number.

# %%
by_count = gm.sample(part, count=300)
print(by_count.summary())

# %% [markdown]
# The second one is a distance: no point of the part may be farther than 6 mm from the nearest probe
# point. `report.coverage` is the distance that was reached.

# %%
by_coverage = gm.sample(part, coverage=6.0)
print(f"{len(by_coverage)} points; all of the lid is within {by_coverage.report.coverage:.2f} mm")

# %% [markdown]
# The third one is an angle: every normal of the lid is within this angle, here 3 degrees, of the
# normal of a probe point.

# %%
by_angle = gm.sample(part, angle=3.0)
print(f"{len(by_angle)} points; every normal is within {by_angle.report.angle:.2f}° of one")

# %% [markdown]
# The three samplings, from above. `kind` is the origin of a point: a point with one of the
# prescribed normals, which are uniform on the sphere, or one that fills a gap between these. A rib
# is nearly developable (K ≈ 0), so that most of its points fill gaps.

# %%
figure, axes = plt.subplots(1, 3, figsize=(9, 2.9), dpi=70, layout="constrained")
for axis, samples, title in zip(
    axes, (by_count, by_coverage, by_angle), ("count", "coverage", "angle"), strict=True
):
    for kind, colour in (("normal", "tab:blue"), ("filling", "tab:orange")):
        x, y, _ = samples.points[samples.kind == kind].T
        axis.scatter(x, y, s=4, color=colour, label=kind)
    axis.set_title(f"{title}: {len(samples)} points")
    axis.set_aspect("equal")
axes[0].legend(loc="lower left", fontsize=7)
plt.show()

# %% [markdown]
# ## The centre of the probe
#
# The machine knows the centre of the ball at the tip of its probe. When the ball (radius 1.5 mm)
# touches a point, its centre is 1.5 mm away along the normal: on the *offset surface*.

# %%
probe = by_coverage.offset(1.5)
np.testing.assert_allclose(probe.points, by_coverage.points + 1.5 * by_coverage.normals)
print(probe.summary())

# %% [markdown]
# A ball whose radius exceeds the smallest radius of curvature of a concave region cannot touch all
# of it. Then the offset folds, and gaussmap warns. The normals point up, and concave regions have
# negative curvatures: the smallest radius is −1 / κ, with the smallest principal curvature κ.

# %%
radius = -1 / by_coverage.principal_curvatures.min()
print(f"the sharpest hollow has radius {radius:.2f} mm")
assert radius > 1.5  # the ball fits everywhere

# %% [markdown]
# ## The approach, and the file
#
# The probe starts 4 mm above each point and moves against the normal. Seen from the side:

# %%
start = probe.offset(4.0)
near = np.abs(probe.points[:, 1]) < 4
figure, axis = plt.subplots(figsize=(7, 2.4), dpi=70, layout="constrained")
across = np.linspace(-40, 40, 400)
axis.plot(across, lid(across, 0 * across)[:, 2], color="0.6")
path = np.stack([start.points[near], probe.points[near]])
axis.plot(path[..., 0], path[..., 2], color="tab:blue", linewidth=0.7)
axis.scatter(*by_coverage.points[near][:, [0, 2]].T, s=8, color="tab:red", zorder=3)
axis.set_aspect("equal")
axis.set(xlabel="x / mm", ylabel="z / mm", title="points within 4 mm of the middle, and paths")
plt.show()

# %% [markdown]
# A .csv file has a line for each point; .ply, .npz, .xyz and .vtp are possible, too.

# %%
by_coverage.write("probe_points.csv")
with open("probe_points.csv", encoding="utf-8") as file:
    for _ in range(3):
        print(file.readline().rstrip()[:75], "…")
