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
from scipy.spatial import KDTree

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
# Many samples with normals make a picture: each pixel shows one, in the light that falls on its
# normal, and pixels where two faces meet are dark. (This cell is about drawing only.)

# %%
dense = gm.sample(part, 80_000, density="uniform")
BACK = np.array([0.72, -0.50, 0.48]) / np.linalg.norm([0.72, -0.50, 0.48])  # to the viewer
RIGHT = np.cross([0, 0, 1], BACK) / np.hypot(*BACK[:2])
AXES = np.stack([RIGHT, np.cross(BACK, RIGHT), BACK])
LIGHT, PIXEL = np.array([-0.35, 0.55, 0.76]), 0.2  # from the left and above; mm

# Of the samples that face the viewer, and are near a pixel: the nearest one that is in front.
facing = np.flatnonzero(dense.normals @ BACK > 0)
seen = dense.points[facing] @ AXES.T
(x0, y0, _), (x1, y1, _) = seen.min(axis=0) - 1, seen.max(axis=0) + 1
pixels = np.stack(np.meshgrid(np.arange(x0, x1, PIXEL), np.arange(y0, y1, PIXEL)), axis=-1)
distance, near = KDTree(seen[:, :2]).query(pixels, k=12, distance_upper_bound=0.45)
depth = np.append(seen[:, 2], -np.inf)[near]
front = depth.max(axis=-1)
distance[depth < front[..., None] - 1] = np.inf
shown = np.take_along_axis(near, distance.argmin(axis=-1)[..., None], axis=-1)[..., 0]
shown = np.where(np.isfinite(front), np.append(facing, -1)[shown], -1)


def picture(axis, colours, title):
    """Draw the part, with a colour (red, green, blue) for each of the dense samples."""
    shade = 0.5 + 0.5 * np.clip(dense.normals @ AXES.T @ LIGHT, 0, 1)
    image = np.append(colours * shade[:, None], [[1, 1, 1]], axis=0)[shown]
    face = np.append(np.asarray(dense.face_index), -1)[shown]
    for side in (0, 1):
        image[face != np.roll(face, 1, side)] = 0.2
    axis.imshow(image, origin="lower", extent=(x0, x1, y0, y1))
    axis.set_axis_off()
    axis.set_title(title)


def visible(points, normals):
    """Return which points the viewer sees."""
    x, y, z = (points @ AXES.T).T
    row, column = ((y - y0) / PIXEL).astype(int), ((x - x0) / PIXEL).astype(int)
    return (normals @ BACK > 0) & (z > front[row, column] - 1)


figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), dpi=80, layout="constrained")
of_file = np.array([face.color for face in part.faces])[dense.face_index]
picture(axes[0], of_file, "colours of the file")
by_curvature = plt.cm.coolwarm(0.5 + 2 * dense.mean_curvature)[:, :3]
picture(axes[1], by_curvature, "mean curvature: convex red, concave blue")
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

figure, axes = plt.subplots(1, 3, figsize=(10, 3.3), dpi=80, layout="constrained")
for axis, samples, title in zip(
    axes, (by_count, by_angle, by_coverage), ("count", "angle", "coverage"), strict=True
):
    picture(axis, np.full((len(dense), 3), 0.93), f"{title}: {len(samples)} points")
    in_sight = visible(samples.points, samples.normals)
    axis.scatter(*(samples.points[in_sight] @ AXES[:2].T).T, s=5, color="tab:blue")
plt.show()

# %% [markdown]
# ## A plan for the machine
#
# Only machined faces are measured: those that the file shows in brass colour. The probe starts
# 5 mm away, outside of the material, since normals point out of the solid; the centre of its ball
# (radius 1 mm) stops 1 mm from the point. Weights are areas: what a point stands for.

# %%
machined = [face.index for face in part.faces if face.color != part.faces[0].color]
chosen = np.isin(np.asarray(by_coverage.face_index), machined)
points, normals = by_coverage.points[chosen], by_coverage.normals[chosen]
start, stop = points + 5.0 * normals, points + 1.0 * normals
area = by_coverage.weights()
np.testing.assert_allclose(area.sum(), part.area, rtol=1e-6)
for index in machined:
    of_face, face = by_coverage.face_index == index, part.faces[index]
    print(
        f"face {index:2} ({face.kind}): {of_face.sum():2} points for {area[of_face].sum():.1f} mm²"
    )

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

figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), dpi=80, layout="constrained")
in_sight = visible(points, normals)
picture(axes[0], 0.6 + 0.4 * of_file, "paths of the probe to machined faces")
paths = np.stack([start[in_sight], points[in_sight]]) @ AXES[:2].T
axes[0].plot(paths[..., 0], paths[..., 1], color="tab:blue", linewidth=0.8)
axes[0].scatter(*paths[1].T, s=6, color="tab:red", zorder=3)
places = with_edges.points[edge]
in_sight = visible(places + 0.3 * (normal + other), normal) | visible(places, other)
picture(axes[1], np.full((len(dense), 3), 0.93), "points on edges, with both normals")
for side, colour in ((normal, "tab:blue"), (other, "tab:orange")):
    arrow = np.stack([places[in_sight], places[in_sight] + 2.5 * side[in_sight]]) @ AXES[:2].T
    axes[1].plot(arrow[..., 0], arrow[..., 1], color=colour, linewidth=0.8)
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
