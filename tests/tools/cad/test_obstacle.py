"""The mesh of a part that rays are tested against."""

import gaussmap as gm
import pytest
from gaussmap.tools.cad import obstacle

for extra in ("trimesh", "rtree", "pythoncdt"):
    pytest.importorskip(extra)
pytestmark = pytest.mark.compiled


def test_the_mesh_of_a_part_is_made_once_with_vertices_enough(parts, monkeypatch):
    monkeypatch.setattr(obstacle, "VERTICES", 10)  # and 8 corners
    part, made = parts.box(), []
    make = obstacle.mesh_of_part
    monkeypatch.setattr(obstacle, "mesh_of_part", lambda *x: made.append(make(*x)) or made[-1])
    samples = gm.sample(part, 60)
    assert samples.unobstructed(1.0).all()
    assert samples[:5].unobstructed(2.0, by=part).all()
    assert [len(x.vertices) for x in made] == [16]
    with pytest.raises(gm.errors.InputError, match=r"give the whole part, .* by=part\)"):
        gm.sample(part.select(index=[0]), 20).unobstructed(1.0)
