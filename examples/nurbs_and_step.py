"""Points with normals of a NURBS surface, and of a part in a STEP file.

The part is docs/gallery/bracket.step, in the current folder. Needs `pip install "gaussmap[cad]"`.
"""

import gaussmap as gm
import numpy as np

# A quarter of a cylinder of radius 1 and height 2, exactly: rational of degree 2 around the axis.
net = np.array([[[1, 0, z], [1, 1, z], [0, 1, z]] for z in (0.0, 2.0)]).swapaxes(0, 1)
weights = np.array([[1, 1], [np.sqrt(0.5), np.sqrt(0.5)], [1, 1]])
knots = [0, 0, 0, 1, 1, 1], [0, 0, 1, 1]
quarter = gm.Surface.from_nurbs((2, 1), knots, net, weights)
samples = gm.sample(quarter, 500)
print(samples.summary())

part = gm.read_cad("bracket.step")
on_part = gm.sample(part, 5_000)
on_part.write("bracket.ply")
print(f"{len(part.faces)} faces in {part.unit}, area {part.area:.2f}, {len(part.solids)} solid")
print(on_part.summary())

# --- Is it true? The quarter by its equation, the part by its planes and its bore. ---

x, y, z = samples.points.T
assert len(samples) == 500
assert np.abs(np.hypot(x, y) - 1).max() < 1e-14
outward = np.stack([x, y, 0 * x], axis=1)
assert np.abs(np.abs((samples.normals * outward).sum(axis=1)) - 1).max() < 1e-14
assert min(x.min(), y.min(), z.min()) >= 0
assert z.max() <= 2
# 2,000 triangles and more: less than 0.1 of arc, which is longer than its chord by 1/24 of 0.1².
assert abs(samples.weights().sum() - np.pi) < np.pi * 0.1**2 / 24 + 1e-3

points, normals = on_part.points, on_part.normals
assert len(on_part) == 5_000
assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-14
assert (points.min(axis=0) >= -1e-9).all()  # the base is 60 mm long and 40 mm wide, from 0 on
assert (points.max(axis=0)[:2] <= np.array([60, 40]) + 1e-9).all()
base = np.abs(points[:, 2]) < 1e-9
assert base.any()
assert np.abs(normals[base] - [0, 0, -1]).max() < 1e-12  # out of the solid
from_axis = points[:, 1:] - [20, 35]
bore = np.abs(np.hypot(*from_axis.T) - 8) < 1e-9  # its radius is 8 mm, around y = 20, z = 35
bore &= np.abs(normals[:, 0]) < 0.5  # and not on the rim
assert bore.sum() > 20
assert np.abs((normals[bore, 1:] * from_axis[bore]).sum(axis=1) / 8 + 1).max() < 1e-9
