"""The mesh of a part that rays are tested against."""

import gaussmap as gm
import pytest
from gaussmap.tools.cad import obstacle
from gaussmap.tools.cad.examples import box

from ...refusals import refused
from .made import noted

for extra in ("trimesh", "rtree", "pythoncdt"):
    pytest.importorskip(extra)
pytestmark = pytest.mark.compiled


def test_the_mesh_of_a_part_is_made_once_with_vertices_enough(monkeypatch):
    monkeypatch.setattr(obstacle, "VERTICES", 10)  # and 8 corners
    part, made = box(), noted(monkeypatch, obstacle, "mesh_of_part", lambda _, mesh: mesh)
    samples = gm.sample(part, 60)
    assert samples.unobstructed(1.0).all()
    assert samples[:5].unobstructed(2.0, by=part).all()
    assert [len(x.vertices) for x in made] == [16]
    some = gm.sample(part.select(index=[0]), 20)
    refused(r"give the whole part, .* by=part\)", some.unobstructed, 1.0)
