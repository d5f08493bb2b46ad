# %% [markdown]
# # Meshing: small triangles where the curvature is large
#
# A mesh with M vertices approximates a smooth surface. Its quality depends on the positions of the
# vertices. Here the same mesher gets two sets: uniform, and dense where the curvature is large.

# %%
import gaussmap as gm
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# The surface is a ring of varying thickness, a *Dupin cyclide*.

# %%
surface = gm.surfaces.dupin_cyclide()
print(gm.surfaces.describe("dupin_cyclide"))

# %%
COUNT = 1000
even = gm.sample(surface, count=COUNT, density="uniform")
balanced = gm.sample(surface, count=COUNT, density="balanced")
for samples in (even, balanced):
    print(samples.summary())

# %% [markdown]
# `mesh()` connects the samples by triangles: by default well-shaped ones, here ones that deviate
# from the normals as little as possible. The mesh is closed if the surface is; both meshes have no
# border, and the Euler characteristic 0 of a torus.

# %%
meshes = {"uniform": even.mesh(prefer="normals"), "balanced": balanced.mesh(prefer="normals")}
for name, mesh in meshes.items():
    assert len(mesh.boundary_edges) == 0
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
# The true normal of the surface is known at each vertex. `angles` are the largest angles between
# the normal of a triangle and the normals at its corners. They are seen as facets in a reflection.

# %%
for name, mesh in meshes.items():
    middle, most, worst = np.quantile(mesh.angles, [0.5, 0.99, 1])
    print(f"{name:9} median {middle:5.2f}°, 99 % below {most:5.2f}°, largest {worst:5.2f}°")

# %% [markdown]
# Uniform samples give slightly smaller angles on average: most triangles lie on the thick side,
# where the curvature is small. Where the ring is thin they are too large. In the balanced mesh the
# largest angles are about two thirds as large.

# %%
figure, axis = plt.subplots(figsize=(6, 2.6), dpi=75, layout="constrained")
for name, mesh in meshes.items():
    axis.hist(mesh.angles, bins=62, range=(0, 31), histtype="step", label=name)
axis.set(xlabel="angle between triangle and normal / degrees", ylabel="triangles")
axis.legend()
plt.show()

# %% [markdown]
# The volume is another test. `weights()` gives it from the samples and their normals, more
# accurately than the flat triangles do; a much larger sampling is the reference.

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
# `write` has the formats .ply, .obj, .stl, .3mf, .vtu, .vtp and .glb. `to_trimesh` and
# `to_pyvista` convert the mesh without a file.

# %%
meshes["balanced"].write("cyclide.obj")
solid = meshes["balanced"].to_trimesh()
print("watertight:", solid.is_watertight, "– volume:", round(float(solid.volume), 4))
