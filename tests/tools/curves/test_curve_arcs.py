"""Samples on the curve itself: all of them, on it, with the prescribed normals."""

from collections.abc import Callable

import gaussmap as gm
import numpy as np
import pytest

from ...shapes import Array

Curve = gm.curves.Curve


def star(lobes: int = 5, depth: float = 0.3) -> Curve:
    r = f"(1 + {depth}*cos({lobes}*t))"
    return Curve.from_sympy((f"{r}*cos(t)", f"{r}*sin(t)"), "t", (0, "2*pi"), True, name="star")


def tangents_of_star(t: Array, lobes: int = 5, depth: float = 0.3) -> Array:
    """Return x′, by the product rule."""
    r, d = 1 + depth * np.cos(lobes * t), -depth * lobes * np.sin(lobes * t)
    return np.stack([d * np.cos(t) - r * np.sin(t), d * np.sin(t) + r * np.cos(t)], axis=-1)


def counted(tangents: Callable[[Array], Array], normals: Array, turn: float) -> list[int]:
    """Return how many points have each normal: the changes of sign at 200,000 parameters."""
    t = np.linspace(0.0, turn, 200_001)
    x = tangents(t)
    outward = np.stack([x[:, 1], -x[:, 0]], axis=-1)
    found = []
    for n in normals:
        below = x @ n < 0.0
        places = np.flatnonzero(below[:-1] != below[1:])
        found.append(int(np.count_nonzero(outward[places] @ n > 0.0)))
    return found


@pytest.mark.compiled
@pytest.mark.parametrize(("lobes", "depth"), [(5, 0.3), (7, 0.1), (3, 0.9)])
def test_every_point_of_a_star(lobes: int, depth: float) -> None:
    curve, normals = star(lobes, depth), gm.directions.circle(500)
    samples = gm.curves.sample(curve, normals=normals)
    expected = counted(lambda t: tangents_of_star(t, lobes, depth), normals, 2 * np.pi)
    assert np.bincount(samples.normal_index, minlength=500).tolist() == expected
    x = tangents_of_star(samples.parameters, lobes, depth)
    found = np.stack([x[:, 1], -x[:, 0]], axis=1) / np.linalg.norm(x, axis=1, keepdims=True)
    assert np.abs(found - normals[samples.normal_index]).max() < 1e-12
    assert np.allclose(samples.points, curve.evaluate(samples.parameters), atol=1e-14)
    signs = np.bincount(samples.normal_index, np.sign(samples.curvature))
    assert (signs == samples.report.turning_number).all()
    assert samples.report.proved == 500
    assert samples.report.on == "curve"
    assert samples.report.inflections == 2 * lobes


def test_where_they_lie() -> None:
    spline = gm.curves.fit(star(), 64)
    normals = gm.directions.circle(16)
    assert gm.curves.sample(spline, normals=normals).report.on == "spline"
    assert gm.curves.sample(star(), normals=normals, pieces=64).report.on == "spline"
    assert gm.curves.sample(star(), normals=normals, on="spline").report.proved is None
    points = Curve.from_points(star().evaluate(np.linspace(0, 6, 40)), closed=True)
    assert gm.curves.sample(points, normals=normals).report.on == "spline"
    untraced = Curve.from_callable(
        lambda t: np.stack([np.where(t > 1.0, t, t), t**2], axis=-1), (-1.0, 2.0)
    )
    assert gm.curves.sample(untraced, normals=[[0.5, -1.0]]).report.on == "spline"
    with pytest.raises(gm.errors.InputError, match="needs bounds of the derivatives"):
        gm.curves.sample(untraced, normals=normals, on="curve")
    with pytest.raises(gm.errors.InputError, match=r'pieces=\.\.\. is for on="spline"'):
        gm.curves.sample(star(), 10, pieces=64, on="curve")
    with pytest.raises(gm.errors.UnknownNameError):
        gm.curves.sample(star(), 10, on="surface")


def test_normals_of_inflections_and_cusps_are_undecided() -> None:
    cubic = Curve.from_sympy(("t", "t**3 + t/2"), "t", (-1, 1), name="cubic")
    normals = [[0.5, -1.0], [1.0, -1.0], [0.2, -1.0]]
    report = gm.curves.sample(cubic, normals=normals).report
    assert report.undecided == (0,)
    assert (report.proved, report.samples >= 2) == (2, True)
    cusp = Curve.from_sympy(("t**2", "t**3"), "t", (-1, 1), name="cusp")
    samples = gm.curves.sample(cusp, normals=[[0.3, -1.0], [1.0, 0.0]])
    assert samples.report.proved == 0
    assert samples.report.undecided == (0, 1)
