# %% [markdown]
# # Inspection: from a STEP file to the points that a probe touches
#
# A coordinate measuring machine touches a part at chosen points and compares them with the
# drawing. It needs the place of each point, the **normal**, along which the probe approaches, and
# a way to it on which the probe runs into nothing.

# %%
import csv

import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## The faces to be measured
#
# `gm.read_cad` reads STEP, IGES and BREP files with Open CASCADE (`pip install 'gaussmap[cad]'`).
# `gm.read_part` reads what `part.save` wrote, and needs no Open CASCADE.

# %%
folder = gm.__path__[0] + "/docs/gallery"
try:
    bracket = gm.read_cad(f"{folder}/bracket.step")
except gm.errors.MissingExtraError:
    bracket = gm.read_part(f"{folder}/bracket.npz")
print(bracket, "of", f"{np.ptp(bracket.bounds, axis=0)} {bracket.unit}")

# %% [markdown]
# Only machined faces are measured, which the file shows in brass colour: a bore, two holes and
# their countersinks. `select` makes a part of them. `dimensions` are those of the drawing, and
# `source_index` is the number of the face in the file.

# %%
machined = bracket.select(color=(0.85, 0.60, 0.20))
for face in machined.faces:
    sizes = [f"{x} {y:.6g}" for x, y in face.dimensions.items() if x in ("radius", "half_angle")]
    print(f"{face.source_index:2}  {face.kind:8} ", *sizes)

# %% [markdown]
# ## Points with normals
#
# No place of these faces is farther than 3.5 mm from a point. The part lies on the table, and the
# probe comes from above: `reach` leaves out what faces down by more than 5°.

# %%
samples = gm.sample(machined, coverage=3.5, reach=((0, 0, 1), 95))
print(samples.summary())

# %% [markdown]
# ## Centres of the ball, and the way to them
#
# When the ball at the tip of the probe (radius 1 mm) touches a point, its centre is on the
# *offset*: 1 mm away along the normal. From there the probe withdraws by 8 mm along the normal, if
# nothing is in its way. `unobstructed` tests that against the whole bracket, not only the selected
# faces.

# %%
centres = samples.offset(1.0)
free = centres.unobstructed(8.0, by=bracket)
print(f"{free.sum()} of {len(free)} points have 8 mm")
kinds = np.array([machined.faces[k].kind for k in samples.face_index])
radii = np.array([machined.faces[k].dimensions.get("radius", np.nan) for k in samples.face_index])
for radius in (3.5, 8.0):
    print(f"bores of radius {radius}: {free[radii == radius].mean():.0%} of the points")

# %% [markdown]
# Walls of the holes are opposite to one another, and 7 mm are too narrow. There, 3 mm have to do.

# %%
way = np.where(free, 8.0, 3.0)
assert centres.unobstructed(3.0, by=bracket).all()
starts = centres.points + way[:, None] * centres.normals

# %% [markdown]
# On the left are the points, with the faces that were selected; on the right is a section through
# a hole, with the ways of the ball.

# %%
figure = plt.figure(figsize=(9, 3.6), dpi=80, layout="constrained")
halves = figure.add_gridspec(1, 2, width_ratios=(5, 4))
axis = figure.add_subplot(halves[0], projection="3d")
bracket.plot(samples, axes=axis, color=way, view=(50, -40))
axis.set_axis_off()
axis.set_title("ways of 3 mm (violet) and of 8 mm (yellow)", fontsize=9)

axis = figure.add_subplot(halves[1])
near = (np.abs(samples.points[:, 1] - 8) < 2) & (np.abs(samples.normals[:, 1]) < 0.5)
for one in np.flatnonzero(near):
    x, z = np.stack([samples.points[one], centres.points[one], starts[one]])[:, [0, 2]].T
    axis.plot(x[1:], z[1:], color="tab:green" if free[one] else "tab:red", linewidth=1.2)
    axis.add_patch(plt.Circle((x[1], z[1]), 1.0, color="0.7", linewidth=0))
    axis.plot(x[0], z[0], "k.", markersize=4)
mesh = gm.sample(bracket, 6000).mesh()
for corners in mesh.vertices[mesh.triangles]:
    height = corners[:, 1] - 8.01  # no corner is on the section
    ends = [(a, b) for a, b in ((0, 1), (1, 2), (2, 0)) if height[a] * height[b] < 0]
    cut = [(height[b] * corners[a] - height[a] * corners[b])[[0, 2]] for a, b in ends]
    cut = [x / (height[b] - height[a]) for x, (a, b) in zip(cut, ends, strict=True)]
    axis.plot(*np.reshape(cut, (-1, 2)).T, color="0.3", linewidth=1)
axis.set(xlim=(34, 62), ylim=(-2, 20), aspect="equal", xlabel="x / mm", ylabel="z / mm")
axis.set_title("section y = 8 mm", fontsize=9)
plt.show()

# %% [markdown]
# ## The file for the machine
#
# Each row of the .csv file has the point, its normal, and what the face is: its number in the file,
# name, kind and radius. Columns of lengths name their unit. `gaussmap sample bracket.step
# --coverage 3.5 --reach 0 0 1 95 -o probe.csv` writes the same of all faces.

# %%
samples.write("probe.csv", fields=("points", "normals", "face_index"))
with open("probe.csv", encoding="utf-8") as file:
    rows = list(csv.DictReader(file))
print(*rows[0], sep=", ")
for row in rows[:: len(rows) // 4]:
    numbers = [f"{float(row[x]):.2f}" for x in list(row)[:6]]
    print(*numbers, row["source_index"], row["face_kind"], row["face_radius [mm]"])
