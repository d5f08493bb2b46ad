# %% [markdown]
# # CAD parts: from a STEP file to inspection points
#
# A measuring machine needs points on the real part, with the normals along which its probe
# approaches. gaussmap takes them from the STEP file itself, without a mesh in between: each point
# lies on its face, and its normal is exact.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## The file
#
# `gm.read_cad` reads STEP, IGES and BREP files with Open CASCADE, which
# `pip install 'gaussmap[cad]'` brings. What it returns holds arrays only. `part.save` writes them,
# and `gm.read_part` reads them on machines without Open CASCADE. Both files are in `docs/gallery`.

# %%
folder = gm.__path__[0] + "/docs/gallery"
try:
    part = gm.read_cad(f"{folder}/bracket.step")
except gm.errors.MissingExtraError:
    part = gm.read_part(f"{folder}/bracket.npz")  # what part.save wrote

print(part)
print(f"{part.area:.0f} {part.unit}²; normals point outward: {part.oriented}")
for face in part.faces:
    print(f"{face.index:2}  {face.kind:8}  {face.area:7.1f} mm²  loops: {len(face.loops)}")

# %% [markdown]
# ## What it looks like
#
# `part.plot` draws samples on the part, each in the colour of a value: on the left of the machined
# faces, which have another colour in the file, on the right of the mean curvature.

# %%
LOOK = {"dpi": 80, "subplot_kw": {"projection": "3d"}, "layout": "constrained"}
VIEW = (28, -35)
dense = gm.sample(part, 5_000, density="uniform")
machined = np.array([face.color != part.faces[0].color for face in part.faces])
figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), **LOOK)
for axis, color, title in (
    (axes[0], machined[dense.face_index].astype(float), "machined faces"),
    (axes[1], np.clip(dense.mean_curvature, -0.3, 0.3), "mean curvature: concave to convex"),
):
    part.plot(dense, axes=axis, color=color, view=VIEW)
    axis.set_axis_off()
    axis.set_title(title)
plt.show()

# %% [markdown]
# ## How many points?
#
# A number, an angle, or a distance; each holds for the part as a whole. By default there are more
# points where the curvature is larger, and each face has some if there are enough.

# %%
by_count = gm.sample(part, count=400)
by_angle = gm.sample(part, angle=20.0)
by_coverage = gm.sample(part, coverage=5.0)
for samples in (by_count, by_angle, by_coverage):
    print(samples.summary())

figure, axes = plt.subplots(1, 3, figsize=(10, 3.3), **LOOK)
for axis, name, samples in zip(
    axes, ("count", "angle", "coverage"), (by_count, by_angle, by_coverage), strict=True
):
    part.plot(samples, axes=axis, view=VIEW)
    axis.set_axis_off()
    axis.set_title(f"{name}: {len(samples)} points")
plt.show()

# %% [markdown]
# ## Edges
#
# `edges=True` adds points on sharp edges, with the normals of both faces: the machine can check
# where a bore begins, and how sharp its edge is. Tangent fillets have no sharp edges.

# %%
with_edges = gm.sample(part, coverage=5.0, edges=True)
edge = with_edges.kind == "edge"
normal, other = with_edges.normals[edge], np.asarray(with_edges.other_normals)[edge]
angles = np.degrees(np.arccos(np.clip(np.sum(normal * other, axis=1), -1, 1)))
print(
    f"{edge.sum()} points on edges; the normals differ by {angles.min():.0f} to {angles.max():.0f}°"
)

figure, axis = plt.subplots(figsize=(4.5, 3.6), **LOOK)
part.plot(with_edges, axes=axis, color=edge.astype(float), view=VIEW)
axis.set_axis_off()
axis.set_title("points on edges (yellow) and on faces")
plt.show()

# %% [markdown]
# ## Files
#
# A .csv file has a line for each point, a .ply file opens in viewers of point clouds; both have the
# face of each point. On the command line, `gaussmap faces bracket.step` lists the faces, and
# `gaussmap sample bracket.step --coverage 5 --edges -o points.ply` does what this page does.

# %%
with_edges.write("points.ply")
by_coverage.write("points.csv")
with open("points.csv", encoding="utf-8") as file:
    for _ in range(3):
        print(file.readline().rstrip()[:75], "…")
