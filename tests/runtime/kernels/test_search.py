"""The two searches, among bins and along the rows of an icosphere, find the same normals."""

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
def test_they_find_the_same(name: str) -> None:
    """The vertices of the icosphere lie in planes of symmetry: some pairs are decided exactly."""
    surface, cells = SURFACES[name]
    spline = gm.fit(surface, cells)
    normals = gm.icosphere(FREQUENCY)
    order = np.random.default_rng(0).permutation(len(normals))
    fields = ("normal_index", "patch_index")
    along_rows = gm.sample(spline, normals=normals, fields=fields)
    of_bins = gm.sample(spline, normals=np.array(normals)[order], fields=fields)
    found = zip(order[of_bins.normal_index], of_bins.patch_index, strict=True)
    assert sorted(found) == sorted(
        zip(along_rows.normal_index, along_rows.patch_index, strict=True)
    )
    assert len(along_rows) > spline.patches
