"""Samples of parts that Open CASCADE made, compared with what it says of them."""

# pyright: reportMissingImports=false

import gaussmap as gm
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.opencascade.parts import part_record
from gaussmap.tools.cad.part import part_of
from gaussmap.tools.cad.source import prepared
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_State

from .conftest import written
from .shapes import (
    as_nurbs,
    ball,
    box,
    cut,
    cylinder,
    lie_on_faces,
    rounded,
    torus,
)

IN, OUT = TopAbs_State.TopAbs_IN, TopAbs_State.TopAbs_OUT


def hole(*direction):
    return cylinder(0.8, 6.0, (2.0, 1.5, -1.0), direction)


def holed_box():
    """Return a box with a round edge and a round hole."""
    return cut(rounded(box(4.0, 3.0, 2.0), 0.3, most=1), hole(0.0, 0.0, 1.0))


def holed_ball():
    """Return a sphere with a slanted hole: its borders are no simple curves."""
    return cut(ball(1.9, (2.2, 1.8, 1.0)), hole(0.2, 0.1, 1.0))


@pytest.fixture(scope="module", params=[holed_box, holed_ball])
def made(request, tmp_path_factory):
    """Return a shape, and the part that is read."""
    folder = tmp_path_factory.mktemp("cad")
    path = written(request.param(), folder / "part.brep")
    return request.param(), part_of(part_record(prepared(path, folder), "part", None))


def test_samples_lie_on_their_own_faces(made):
    shape, part = made
    samples = gm.sample(part, 150)
    assert (len(samples), samples.report.empty_faces) == (150, 0)
    lie_on_faces(samples, part, shape, inside=True)
    assert samples.weights().sum() == pytest.approx(part.area, rel=1e-6)


def test_normals_point_out_of_the_solid(made):
    shape, part = made
    samples = gm.sample(part, 40)
    assert part.oriented
    classifier = BRepClass3d_SolidClassifier(shape)
    for point, normal in zip(samples.points, samples.normals, strict=True):
        for side, state in ((5e-7, OUT), (-5e-7, IN)):  # some are as near to edges as that
            classifier.Perform(gp_Pnt(*(point + side * normal).tolist()), 1e-9)
            assert classifier.State() == state


@pytest.mark.parametrize(
    ("shape", "flat"),
    [(torus(2.0, 0.7), 0), (cut(ball(2.0), box(4.0, 4.0, 4.0, at=(-2.0, -2.0, -3.0))), 1),
     (as_nurbs(torus(2.0, 0.7)), 0), (cylinder(1.0, 2.0), 3)],
)  # fmt: skip
def test_the_developable_share_is_that_of_planes_and_cylinders(shape, flat, part_with):
    part = part_with(shape)
    areas = [x.area for x in part.faces if x.kind in ("plane", "cylinder")]
    assert len(areas) == flat
    share = gm.sample(part, 100).report.developable_share
    assert share == pytest.approx(sum(areas) / part.area, rel=1e-9)
