# %% [markdown]
# # Meshing: triangles where they are needed
#
# A mesh with M vertices stands for a smooth surface. How good it is depends on where the vertices
# are. Here the same mesher gets two sets of them: spread evenly, and dense where the surface bends.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# The surface is a thin ring with a fat side, a *Dupin cyclide*.

# %%
surface = gm.surfaces.dupin_cyclide()
print(gm.surfaces.describe("dupin_cyclide"))

# %%
COUNT = 1000
even = gm.sample(surface, count=COUNT, density="uniform", relax=2)
balanced = gm.sample(surface, count=COUNT, density="balanced", relax=2)
for samples in (even, balanced):
    print(samples.summary())

# %% [markdown]
# `mesh()` joins the samples to triangles. It closes where the surface closes; both meshes have no
# border, and the Euler characteristic 0 of a ring.

# %%
meshes = {"uniform": even.mesh(), "balanced": balanced.mesh()}
for name, mesh in meshes.items():
    assert len(mesh.boundary) == 0
    assert mesh.euler_characteristic == 0
    print(f"{name:9}", mesh.summary())

# %% [markdown]
# Both meshes, seen from above.

# %%
figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), dpi=65, layout="constrained")
for axis, (name, mesh) in zip(axes, meshes.items(), strict=True):
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    seen = mesh.triangles[normals[:, 2] > 0]
    x, y, _ = mesh.vertices.T
    axis.triplot(x, y, seen, linewidth=0.4, color="tab:blue")
    axis.set(title=f"{name}: {len(mesh.vertices)} vertices", aspect="equal")
plt.show()

# %% [markdown]
# ## How good are they?
#
# Each vertex knows the true normal of the surface. A triangle deviates from the normals at its
# corners by an angle; `angles` is the largest of the three. One sees it as facets in a reflection.

# %%
for name, mesh in meshes.items():
    middle, most, worst = np.quantile(mesh.angles, [0.5, 0.99, 1])
    print(f"{name:9} median {middle:5.2f}°, 99 % below {most:5.2f}°, largest {worst:5.2f}°")

# %% [markdown]
# Uniform samples give slightly better triangles on average: most of them lie on the fat side, where
# anything is good enough. Where the ring is thin they are too large. The balanced mesh has no such
# place: its worst triangles are about half as bad.

# %%
figure, axis = plt.subplots(figsize=(6, 2.6), dpi=75, layout="constrained")
for name, mesh in meshes.items():
    axis.hist(mesh.angles, bins=62, range=(0, 31), histtype="step", label=name)
axis.set(xlabel="angle between triangle and normal / degrees", ylabel="triangles")
axis.legend()
plt.show()

# %% [markdown]
# The volume is another test. `weights()` gives it from the samples and their normals, more
# accurately than the flat triangles do; many more samples tell what is right.

# %%
many = gm.sample(surface, count=50_000, density="uniform")
print(f"50,000 samples: {(many.weights() * many.support).sum() / 3:.4f}")
for name, mesh, samples in (
    ("uniform", meshes["uniform"], even),
    ("balanced", meshes["balanced"], balanced),
):
    flat = np.linalg.det(mesh.vertices[mesh.triangles]).sum() / 6
    bent = (samples.weights() * samples.support).sum() / 3
    print(f"{name:9} volume of the triangles {flat:.4f}, by weights {bent:.4f}")

# %% [markdown]
# ## To other programs
#
# `write` knows .ply, .obj, .stl, .vtk, .vtu and .vtp. `to_trimesh`, `to_pyvista` and `to_open3d`
# hand the mesh on without a file.

# %%
meshes["balanced"].write("cyclide.obj")
solid = meshes["balanced"].to_trimesh()
print("watertight:", solid.is_watertight, "– volume:", round(float(solid.volume), 4))
