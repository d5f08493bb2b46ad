"""The bounds, the volume and the picture of parts."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import all_kinds, box
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import FaceRecord, Geometry

TURN = 2.0 * np.pi
AXES = np.array([[2, 1, -2], [1, 2, 2], [2, -2, 1]]) / 3  # x, y and z of a frame


def circle(radius: float, count: int = 1440) -> np.ndarray:
    angles = np.linspace(0.0, TURN, count, endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


@pytest.fixture(scope="module")
def tube(made) -> Part:
    """Return a tube of radii 1 and 2 and height 3, far from the origin; all loops turn left."""
    place = made.placement((50.0, 70.0, -30.0))
    sides = [
        made.face(
            "cylinder", [*place, r], (0.0, TURN), (0.0, 3.0), TURN * 3 * r, (TURN, 0.0),
            reversed=r == 1.0, solid_index=0,
        )
        for r in (1.0, 2.0)
    ]  # fmt: skip
    ends = [
        made.face(
            "plane", made.placement((50.0, 70.0, z - 30.0)), (-2.0, 2.0), (-2.0, 2.0), 3 * np.pi,
            loops=[circle(2.0), circle(1.0)], reversed=z == 0.0, solid_index=0,
        )
        for z in (0.0, 3.0)
    ]  # fmt: skip
    return made.part([*sides, *ends])


@pytest.fixture(scope="module")
def slanted(made) -> Part:
    """Return a cylinder of radius 1 that is cut off at z = 2 + x/2, seen in another frame."""
    x, _, z = AXES
    place, count = np.concatenate([np.zeros(3), AXES.ravel()]), 720
    u = np.linspace(0.0, TURN, count)
    border = np.concatenate([[(0.0, 0.0), (TURN, 0.0)], np.stack([u, 2 + np.cos(u) / 2], 1)[::-1]])
    # u and v along the axes of the ellipse, the first of length 1/cos of its slope.
    slope = np.sqrt(1.25)
    top = np.concatenate([2 * z, (x + z / 2) / slope, AXES[1], (z - x / 2) / slope])
    ellipse = circle(1.0, count) * [slope, 1.0]
    side = made.face(
        "cylinder", [*place, 1.0], (0.0, TURN), (0.0, 2.5), 4 * np.pi, (TURN, 0.0), loops=[border]
    )
    ends = (-1.0, 1.0), (-1.0, 1.0)
    floor = made.face("plane", place, *ends, np.pi, loops=[circle(1.0)], reversed=True)
    roof = made.face("plane", top, (-slope, slope), (-1, 1), slope * np.pi, loops=[ellipse])
    return made.part([side, floor, roof])


def test_volume_of_a_tube(tube):
    assert tube.volume == pytest.approx(9 * np.pi, rel=1e-12)


def test_volume_below_a_curved_border(slanted):
    """The polygon leaves the border by up to (2π / 720)² / 16."""
    assert slanted.volume == pytest.approx(2 * np.pi, rel=1e-6)


@pytest.mark.parametrize("kind", ["sphere", "torus"])
def test_volumes_of_closed_faces(made, kind):
    place = made.placement((5.0, 7.0, -3.0))
    sphere = [*place, 2.0], (0.0, TURN), (-TURN / 4, TURN / 4), 16 * np.pi, (TURN, 0.0)
    torus = [*place, 2.0, 0.5], (0.0, TURN), (0.0, TURN), TURN**2, (TURN, TURN)
    part = made.part([made.face(kind, *(sphere if kind == "sphere" else torus))])
    volume = {"sphere": 32 * np.pi / 3, "torus": np.pi**2}[kind]
    assert part.volume == pytest.approx(volume, rel=1e-12)


def test_volumes_that_are_not_known(made):
    with pytest.raises(gm.errors.SurfaceError, match="its faces enclose no solids"):
        _ = all_kinds().volume
    failed = FaceRecord(Geometry("unknown"), reason="it has no surface")
    with pytest.raises(gm.errors.SurfaceError, match="some of its faces cannot be used"):
        _ = made.part([*made.box_faces(), failed]).volume


def test_bounds_of_a_tilted_torus(made):
    """Largest inside the face: there is no border near it."""
    place = np.concatenate([[1.0, 2.0, 3.0], AXES.ravel(), [2.0, 0.5]])
    part = made.part([made.face("torus", place, (0, TURN), (0, TURN), TURN**2, (TURN, TURN))])
    extent = 2.0 * np.sqrt(1.0 - AXES[2] ** 2) + 0.5
    np.testing.assert_allclose(part.bounds - [1, 2, 3], [-extent, extent], atol=1e-12)


def test_bounds_at_a_border(slanted):
    x, y, z = AXES
    roof = 2 * z + np.hypot(x + z / 2, y)
    floor = np.hypot(x, y)
    low = np.minimum(2 * z - np.hypot(x + z / 2, y), -floor)
    np.testing.assert_allclose(slanted.bounds, [low, np.maximum(roof, floor)], atol=1e-5)


@pytest.mark.parametrize("part", [box(), all_kinds()], ids=lambda x: x.name)
def test_samples_are_within_the_bounds(part):
    points, (low, high) = gm.sample(part, 2_000).points, part.bounds
    assert (points >= low - 1e-9).all()
    assert (points <= high + 1e-9).all()
    assert (np.ptp(points, axis=0) >= 0.9 * (high - low)).all()


def test_plot():
    pytest.importorskip("matplotlib")
    figure, other = (f(box(), gm.sample(box(), 50)) for f in (Part.plot, gm.plot))
    assert [type(x) for x in figure.axes] == [type(x) for x in other.axes]
    assert len(figure.texts) == len(other.texts) > 0
