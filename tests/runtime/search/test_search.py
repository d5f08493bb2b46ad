"""The kernels of the search find the same whatever the order of normals."""

import gaussmap as gm
import numpy as np
import pytest

FREQUENCY = 7
SURFACES = {
    "torus": (gm.surfaces.torus(), (3, 3)),
    "enneper": (gm.surfaces.enneper(), (3, 3)),  # wide cones
    "ellipsoid_patch": (gm.surfaces.ellipsoid_patch(), (3, 3)),  # dozens of normals for a patch
}
EACH = [pytest.param("torus", marks=pytest.mark.compiled), "enneper", "ellipsoid_patch"]


@pytest.mark.parametrize("name", EACH)
def test_the_order_of_normals_is_that_of_samples(name: str) -> None:
    """The vertices of the icosphere lie in planes of symmetry: some pairs are decided exactly."""
    surface, cells = SURFACES[name]
    spline = gm.fit(surface, cells)
    normals = gm.icosphere(FREQUENCY)
    order = np.random.default_rng(0).permutation(len(normals))
    fields = ("normal_index", "patch_index")
    usual = gm.sample(spline, normals=normals, fields=fields)
    other = gm.sample(spline, normals=np.array(normals)[order], fields=fields)
    first, second = (np.column_stack([*x.arrays().values()]) for x in (usual, other))
    for rows in (first, second):
        assert rows.tolist() == sorted(rows.tolist())
    second[:, 0] = order[second[:, 0]]
    assert sorted(second.tolist()) == first.tolist()
    assert len(usual) > spline.patches
