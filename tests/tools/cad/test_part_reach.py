"""Samples of parts whose normals are within an angle of an axis."""

from __future__ import annotations

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import all_kinds, box

ROUNDING = 1e-9


def angles(normals: np.ndarray, axis: tuple[float, float, float]) -> np.ndarray:
    return np.degrees(np.arccos(np.clip(normals @ (axis / np.linalg.norm(axis)), -1.0, 1.0)))


def test_parts_have_samples_on_faces_that_can_be_reached() -> None:
    part = all_kinds()
    requests: list[dict[str, Any]] = [
        {"count": 200}, {"coverage": 0.3}, {"count": 60, "density": "uniform"}
    ]  # fmt: skip
    for how in requests:
        samples = gm.sample(part, reach=((0, 0, 1), 60.0), **how)
        assert angles(samples.normals, (0, 0, 1)).max() <= 60.0 + ROUNDING
        if "count" in how:
            assert len(samples) == how["count"]
        else:
            assert (samples.report.coverage or np.inf) <= how["coverage"]
    top = gm.sample(box(), 100, reach=((0, 0, 1), 30.0))
    assert {*(top.face_index if top.face_index is not None else ())} == {5}


def test_edges_are_reached_if_both_faces_are() -> None:
    whole = gm.sample(box(), 100, edges=True)
    sides = gm.sample(box(), 100, edges=True, reach=((1, 1, 0), 50.0))
    assert (whole.report.edge_samples or 0) > (sides.report.edge_samples or 0) > 0
    on_edge = sides.kind == "edge"
    assert sides.other_normals is not None
    assert angles(sides.other_normals[on_edge], (1, 1, 0)).max() <= 50.0 + ROUNDING


def test_a_part_without_normals_in_reach_is_refused() -> None:
    with pytest.raises(gm.errors.SurfaceError, match="no normal of part"):
        gm.sample(box(), 100, reach=((1, 1, 1), 10.0))
