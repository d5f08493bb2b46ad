"""Faces in another unit."""

import numpy as np
import pytest
from gaussmap.tools.cad.records import FaceRecord, Geometry
from gaussmap.tools.cad.units import with_unit

from .made import net, placement

CURVE = net([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)], knots=[0.0, 0.0, 5.0, 5.0])
PLACE = placement((1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("geometry", "numbers", "parameters"),
    [
        (Geometry("plane", PLACE), (0, 1, 2), (2.0, 2.0)),
        (Geometry("cylinder", np.array([*PLACE, 7.0])), (0, 1, 2, 12), (1.0, 2.0)),
        (Geometry("cone", np.array([*PLACE, 7.0, 0.5])), (0, 1, 2, 12), (1.0, 2.0)),
        (Geometry("sphere", np.array([*PLACE, 7.0])), (0, 1, 2, 12), (1.0, 1.0)),
        (Geometry("torus", np.array([*PLACE, 7.0, 0.5])), (0, 1, 2, 12, 13), (1.0, 1.0)),
        (Geometry("revolution", PLACE[:6], CURVE), (0, 1, 2), (1.0, 1.0)),
        (Geometry("extrusion", PLACE[3:6], CURVE), (), (1.0, 2.0)),
    ],
)
def test_lengths_are_multiplied_and_angles_are_not(geometry, numbers, parameters):
    loop = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)])
    face = FaceRecord(geometry, ((0.0, 1.0), (0.0, 3.0)), (6.0, 0.0), [loop], area=5.0)
    scaled = with_unit(face, 2.0)
    factors = np.ones(len(geometry.numbers))
    factors[list(numbers)] = 2.0
    np.testing.assert_array_equal(scaled.geometry.numbers, geometry.numbers * factors)
    np.testing.assert_array_equal(scaled.loops[0], loop * parameters)
    u, v = parameters
    assert np.array(scaled.domain).tolist() == [[0.0, u], [0.0, 3.0 * v]]
    assert list(scaled.periods) == [6.0 * u, 0.0]
    assert scaled.area == 20.0
    if geometry.net is not None:
        np.testing.assert_array_equal(scaled.geometry.net.points, 2.0 * CURVE.points)


def test_an_offset_has_the_parameters_of_its_basis():
    basis = Geometry("cylinder", np.array([*PLACE, 7.0]))
    face = FaceRecord(Geometry("offset", np.array([0.5]), basis=basis), loops=[np.ones((3, 2))])
    scaled = with_unit(face, 2.0)
    assert scaled.geometry.numbers.tolist() == [1.0]
    assert scaled.geometry.basis.numbers[12] == 14.0
    np.testing.assert_array_equal(scaled.loops[0], np.ones((3, 2)) * (1.0, 2.0))
