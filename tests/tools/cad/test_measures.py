"""The bounds, the volume and the picture of parts."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import all_kinds, box_edges, box_faces
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import NO_AREA, FaceRecord, Geometry

from ...refusals import refused
from .made import AXES, FAILED, TURN, circle, face, part, placement


@pytest.fixture(scope="module")
def slanted() -> Part:
    """Return a cylinder of radius 1 that is cut off at z = 2 + x/2, seen in another frame."""
    x, _, z = AXES
    place, count = np.concatenate([np.zeros(3), AXES.ravel()]), 720
    u = np.linspace(0.0, TURN, count)
    border = np.concatenate([[(0.0, 0.0), (TURN, 0.0)], np.stack([u, 2 + np.cos(u) / 2], 1)[::-1]])
    # u and v along the axes of the ellipse, the first of length 1/cos of its slope.
    slope, ends = np.sqrt(1.25), (-1.0, 1.0)
    top = placement(2 * z, (z - x / 2) / slope, (x + z / 2) / slope)
    ellipse, area = circle(1.0, count) * [slope, 1.0], np.pi
    return part([
        face("cylinder", 1.0, v=(0.0, 2.5), place=place, area=4 * np.pi, loops=[border]),
        face("plane", u=ends, v=ends, place=place, area=area, loops=[circle()], reversed=True),
        face("plane", u=(-slope, slope), v=ends, place=top, area=slope * area, loops=[ellipse]),
    ])  # fmt: skip


def test_volume_below_a_curved_border(slanted):
    """The polygon leaves the border by up to (2π / 720)² / 16."""
    assert slanted.volume == pytest.approx(2 * np.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("kind", "sizes", "volume"),
    [("sphere", [2.0], 32 * np.pi / 3), ("torus", [2.0, 0.5], np.pi**2)],
)
def test_volumes_of_closed_faces(kind, sizes, volume):
    closed = part([face(kind, *sizes, place=placement((5.0, 7.0, -3.0)))])
    assert closed.volume == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (all_kinds(), "its faces enclose no solids"),
        (part([*box_faces(), FAILED]), "some of its faces cannot be used"),
    ],
)
def test_volumes_that_are_not_known(given, reason):
    refused(reason, lambda: given.volume, error=gm.errors.SurfaceError)


def test_faces_of_no_area_and_open_sheets_do_not_count_in_volumes():
    nothing = FaceRecord(Geometry("unknown"), reason=NO_AREA)
    assert part([*box_faces(), nothing]).volume == pytest.approx(6.0)
    sheet = face("plane", place=placement((9.0, 0.0, 0.0)))
    mixed = part([*box_faces(), sheet, FAILED], oriented=False, edges=box_edges())
    with pytest.warns(gm.GaussmapWarning, match="2 faces of 8 belong to none"):
        assert mixed.volume == pytest.approx(6.0)
    alone, error = part([sheet], oriented=False), gm.errors.SurfaceError
    refused("enclose no solids", lambda: alone.volume, error=error)


def test_bounds_of_a_tilted_torus():
    """Largest inside the face: there is no border near it."""
    tilted = part([face("torus", 2.0, 0.5, place=[1.0, 2.0, 3.0, *AXES.ravel()])])
    extent = 2.0 * np.sqrt(1.0 - AXES[2] ** 2) + 0.5
    np.testing.assert_allclose(tilted.bounds - [1, 2, 3], [-extent, extent], atol=1e-12)


def test_bounds_at_a_border(slanted):
    x, y, z = AXES
    roof = 2 * z + np.hypot(x + z / 2, y)
    floor = np.hypot(x, y)
    low = np.minimum(2 * z - np.hypot(x + z / 2, y), -floor)
    np.testing.assert_allclose(slanted.bounds, [low, np.maximum(roof, floor)], atol=1e-5)
