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
    for samples in (usual, other):
        keys = list(
            zip(
                samples.normal_index.tolist(), samples.arrays()["patch_index"].tolist(), strict=True
            )
        )
        assert keys == sorted(keys)
    found = zip(order[other.normal_index], other.arrays()["patch_index"], strict=True)
    assert sorted(found) == sorted(
        zip(usual.normal_index, usual.arrays()["patch_index"], strict=True)
    )
    assert len(usual) > spline.patches
