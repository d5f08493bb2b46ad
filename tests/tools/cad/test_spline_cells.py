"""Splines of faces: few cells, and accurate normals."""

import math

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.faces import face_surface
from gaussmap.tools.cad.records import Geometry, Net
from gaussmap.tools.cad.spline_cells import search_cells, spline_cells

TURN, HALF = 2.0 * math.pi, math.pi / 2
PLACEMENT = np.array([1.0, 2, 3, 0, 1, 0, 0, 0, 1, 1, 0, 0])


def surface(kind, numbers, domain, **more):
    return face_surface(Geometry(kind, np.append(PLACEMENT, numbers)), domain, **more)


CASES = {
    "plane": (surface("plane", [], ((-1, 5), (0, 1e-3))), (3, 3), 1e-9),
    "cylinder": (surface("cylinder", [2.0], ((0, TURN), (0, 1))), (36, 3), 0.1),
    "fillet": (surface("cylinder", [2.0], ((0, HALF), (0, 9)), is_reversed=True), (9, 3), 0.1),
    "sphere": (surface("sphere", [2.0], ((0, TURN), (-HALF, HALF))), (36, 18), 0.15),
    "torus": (surface("torus", [2.0, 0.5], ((0, TURN), (0, TURN))), (36, 36), 0.15),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_cells_have_ten_degrees(case):
    made, cells, angle = case
    assert spline_cells(made) == cells
    misfit = gm.fit(made, cells).misfit
    assert misfit
    assert misfit.angle is not None
    assert misfit.angle <= angle


def test_each_span_of_a_net_is_looked_at():
    x = np.arange(40.0)
    points = np.stack([x, np.zeros(40), 0.5 * (-1.0) ** x], axis=1)
    net = Net((3,), (np.concatenate([np.zeros(3), np.arange(38.0), np.full(3, 37.0)]),), points)
    waves = face_surface(Geometry("extrusion", np.array([0.0, 1, 0]), net), ((0, 37), (0, 1)))
    m, n = spline_cells(waves)
    assert m > 100
    assert n == 3
    assert search_cells(waves) == (min(2 * m, 256), 64)


def test_an_apex_has_no_direction():
    cone = surface("cone", [0.0, 0.5], ((0, TURN), (0, 1)))
    assert spline_cells(cone) == (36, 3)
