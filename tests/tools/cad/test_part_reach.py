"""Samples of parts whose normals are within an angle of an axis."""

from __future__ import annotations

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import box

from ...refusals import refused
from .made import KINDS

ROUNDING = 1e-9


def angles(normals: np.ndarray, axis: tuple[float, float, float]) -> np.ndarray:
    return np.degrees(
        np.arccos(np.clip(normals @ (np.array(axis) / np.linalg.norm(axis)), -1.0, 1.0))
    )


@pytest.mark.parametrize(
    "how", [{"count": 200}, {"coverage": 0.3}, {"count": 60, "density": "uniform"}]
)
@pytest.mark.quick_for("how2")
def test_parts_have_samples_on_faces_that_can_be_reached(how: dict[str, Any]) -> None:
    samples = gm.sample(KINDS, reach=((0, 0, 1), 60.0), **how)
    assert angles(samples.normals, (0, 0, 1)).max() <= 60.0 + ROUNDING
    if "count" in how:
        assert len(samples) == how["count"]
    else:
        assert (samples.report.coverage or np.inf) <= how["coverage"]


def test_a_box_has_samples_on_its_top() -> None:
    top = gm.sample(box(), 100, reach=((0, 0, 1), 30.0))
    assert {*(top.face_index if top.face_index is not None else ())} == {5}


@pytest.mark.slow
def test_weights_and_deviation_are_those_of_what_is_in_reach() -> None:
    """Of a surface of revolution, of which a sixth is in reach."""
    part, reach = KINDS.select(kind="revolution"), ((1, 1, 1), 60.0)
    whole, some = gm.sample(part, 4000), gm.sample(part, 200, reach=reach)
    within = angles(whole.normals, (1, 1, 1)) <= 60.0
    assert some.weights().sum() == pytest.approx(whole.weights()[within].sum(), rel=0.02)
    assert some.report.reach == pytest.approx((3**-0.5, 3**-0.5, 3**-0.5, 60.0))
    assert whole.report.reach is None
    # What is outside of the reach is farther away, in space and in normal.
    left_out = whole.points[~within]
    farthest = np.linalg.norm(left_out[:, None] - some.points, axis=2).min(axis=1).max()
    assert some.coverage() < farthest / 2
    assert some.normal_deviation().normal_space < 10.0


def test_edges_are_reached_if_both_faces_are() -> None:
    whole = gm.sample(box(), 100, edges=True)
    sides = gm.sample(box(), 100, edges=True, reach=((1, 1, 0), 50.0))
    assert (whole.report.edge_samples or 0) > (sides.report.edge_samples or 0) > 0
    on_edge = sides.kind == "edge"
    assert sides.other_normals is not None
    assert angles(sides.other_normals[on_edge], (1, 1, 0)).max() <= 50.0 + ROUNDING


def test_memory_for_samples_of_a_part_is_refused() -> None:
    known, normal = gm.GaussMap(KINDS), [[0, 0, 1]]
    refused("out=.* holds samples of one spline", known.points, normal, out=known.points(normal))


def test_a_part_without_normals_in_reach_is_refused() -> None:
    reach, error = ((1, 1, 1), 10.0), gm.errors.SurfaceError
    refused("no normal of part", gm.sample, box(), 100, reach=reach, error=error)
