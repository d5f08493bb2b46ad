"""Samples on graded grids."""

from functools import partial
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density.kernels.steps import shared_steps
from gaussmap.tools.density.steps import Forms, equal_steps, steps_for_count

from ...products import covering
from ...refusals import refused

CELLS = (16, 16)


def torus_forms(number: int = 32) -> Forms:
    """The forms of the torus (1, 0.35), at the middles of a grid, by closed formulas."""
    width = np.full(number, 2.0 * np.pi / number)
    v = np.broadcast_to((np.arange(number) + 0.5) * width[0], (number, number))
    zero = np.zeros_like(v)
    first = np.stack([(1.0 + 0.35 * np.cos(v)) ** 2, zero, zero + 0.35**2])
    return Forms(np.stack([np.cos(v) ** 2, zero, zero + 1.0]), first, (width, width))


@pytest.mark.kernels
def test_steps_keep_both_limits_and_use_one_everywhere():
    forms = torus_forms()
    steps = equal_steps(forms, 0.1, 0.08)
    a, b = steps.along[0][:, None], steps.along[1]
    used = [
        np.sqrt(e * a * a + g * b * b) / (2.0 * limit)
        for (e, _, g), limit in ((forms.third, 0.1), (forms.first, 0.08))
    ]
    assert max(x.max() for x in used) <= 1.0 + 1e-12
    assert np.maximum(*used).min() >= 1.0 - 1e-12


def test_steps_for_a_count_have_it_and_the_smallest_angle():
    """Without a distance the integral of equal steps: ∫∫ du dv / a b, by numbers."""
    forms = torus_forms()
    steps = steps_for_count(forms, 5000.0, 10.0)
    assert abs(steps.count / 5000.0 - 1.0) < 0.01
    others = [steps_for_count(forms, 5000.0, distance) for distance in (0.06, 0.05)]
    assert steps.angle < others[0].angle < others[1].angle


@pytest.mark.kernels
@pytest.mark.parametrize("curvature", [0.0, 1.0])
def test_a_step_spans_half_of_the_domain_at_most(curvature: float):
    """On a plane, whatever its sides, and on a cylinder, along which no normal changes."""
    one, zero = np.ones((4, 5)), np.zeros((4, 5))
    first, third = np.stack([one, zero, one]), np.stack([curvature**2 * one, zero, zero])
    steps = equal_steps(Forms(third, first, (np.full(4, 3.0), np.full(5, 0.2))), 0.1, 100.0)
    np.testing.assert_allclose(steps.along[0], 0.2 if curvature > 0.0 else 6.0)
    np.testing.assert_allclose(steps.along[1], 0.5)


def test_too_small_a_distance_is_made_larger():
    assert steps_for_count(torus_forms(), 100.0, 1e-3).count <= 110.0


@covering(count=[1, 2, 7, 500], on=["surface", "spline"])
def test_a_count_is_met_and_lines_are_lines(count: int, on: str):
    samples = gm.sample("torus", count, density="aligned", cells=CELLS, on=on)
    assert len(samples) == count
    if samples.row is None or samples.column is None:
        assert count < 10
        return
    on_grid = samples.row >= 0
    np.testing.assert_array_equal(on_grid, samples.column >= 0)
    places = samples.uv[on_grid]
    for numbers, along in ((samples.row[on_grid], 1), (samples.column[on_grid], 0)):
        lines = [places[numbers == k, along] for k in range(numbers.max() + 1)]
        assert max(np.ptp(x) for x in lines) < 1e-9
        assert (np.diff([x[0] for x in lines]) > 0.0).all()
    assert len(np.unique(samples.points.round(9), axis=0)) == count
    assert (samples.kind[on_grid] == "grid").all()


def test_fields_are_there_if_asked_or_used():
    asked: dict[str, Any] = {"cells": CELLS, "density": "aligned"}
    few = gm.sample("torus", 300, fields=("points", "row"), **asked)
    assert few.fields == ("points", "row")
    assert few.points.dtype == np.float64
    single = gm.sample("torus", 300, dtype=np.float32, **asked)
    assert single.row.dtype == np.int64
    assert "row" not in gm.sample("torus", 1, **asked).fields
    none = gm.sample("torus", 1, fields=("points", "column"), **asked)
    assert none.column is not None
    assert (none.column == -1).all()
    for density in ("balanced", "uniform"):
        how = asked | {"fields": ("points", "row"), "density": density}
        refused("row is a field of samples on a grid only", gm.sample, "torus", 300, **how)


def test_files_keep_rows_and_columns(tmp_path):
    samples = gm.sample("torus", 300, density="aligned", cells=CELLS)
    for name in ("a.npz", "a.ply"):
        samples.write(tmp_path / name)
        again = gm.read_samples(tmp_path / name)
        np.testing.assert_array_equal(again.row, samples.row)
        np.testing.assert_array_equal(again.column, samples.column)
        assert again.report.density == "aligned"


@pytest.mark.parametrize(
    "asked",
    [{"angle": 12.0}, {"coverage": 0.2}, {"angle": 15, "coverage": 0.3},
     {"count": 900, "coverage": 0.15}],
)  # fmt: skip
def test_angles_and_coverages_are_kept(asked: dict[str, Any]):
    samples = gm.sample("torus", density="aligned", cells=CELLS, **asked)
    if "angle" in asked:
        assert samples.normal_deviation().normal_space <= asked["angle"]
    if "coverage" in asked:
        assert samples.coverage() <= 1.1 * asked["coverage"]
    assert len(samples) == asked.get("count", len(samples))


def test_gaps_for_an_angle_are_as_wide_as_documented():
    """On a cylinder no point is farther from a sample than r/κ, where r is twice the angle.

    Lines are whole numbers of steps, two of ten along v: gaps are narrower by 20 % at most.
    """
    cylinder = gm.surfaces.cylinder(radius=0.5, height=2.0)
    samples = gm.sample(cylinder, angle=12.0, density="aligned", cells=CELLS)
    assert samples.row is not None
    farthest = 0.5 * 2.0 * np.radians(12.0)
    assert 0.8 * farthest < samples.coverage() <= farthest


def test_gaps_for_a_count_are_as_wide_as_those_of_usual_samples():
    """On a cylinder, n of these are no closer than √(area / n), and nothing is farther.

    Where the grid has 13 lines, half a step more or less are 4 %; it has no samples at the ends.
    """
    cylinder = gm.surfaces.cylinder(radius=0.5, height=2.0)
    samples = gm.sample(cylinder, 1000, density="aligned", cells=CELLS)
    assert samples.row is not None
    assert 0.9 < samples.coverage() / np.sqrt(2.0 * np.pi / 1000) < 1.25


def test_a_trimmed_grid_keeps_the_count_and_the_trim():
    part = gm.surfaces.torus().trimmed([[(1, 1), (4, 1), (1, 4)]])
    samples = gm.sample(part, 800, density="aligned", cells=CELLS)
    assert len(samples) == 800
    assert part.trim.contains(samples.uv).all()
    assert (samples.row >= 0).sum() > 500


def test_only_aligned_samples_are_on_a_grid():
    """Parameters of a torus are lines of curvature: there a grid has smaller angles."""
    few = gm.sample("torus", 27, density="aligned", cells=CELLS)
    assert 0 < np.count_nonzero(few.row < 0) < len(few)
    aligned, balanced = (gm.sample("torus", 1000, density=x) for x in ("aligned", "balanced"))
    assert aligned.report.density == few.report.density == "aligned"
    assert "on a grid that follows the curvature" in aligned.summary()
    assert balanced.report.density is balanced.row is balanced.column is None
    assert set(balanced.kind) == {"normal", "filling"}
    assert aligned.normal_deviation().space < 0.8 * balanced.normal_deviation().space


def profile(u: Any, v: Any) -> Any:
    """Return points of a plane, a quarter of a cylinder and a plane."""
    angle, after = np.clip(u - 1.0, 0.0, 1.5), np.maximum(u - 2.5, 0.0)
    x = np.minimum(u, 1.0) + np.sin(angle) + after * np.cos(1.5)
    return np.stack([x, v, 1.0 - np.cos(angle) + after * np.sin(1.5)], axis=-1)


def revolved(u: Any, v: Any, jump: float) -> Any:
    """Return points of two arcs of a profile, of curvature 1 and 1 − jump."""
    bend = 1.0 - jump
    first, second = np.minimum(u, 1.0) - 1.0, bend * np.maximum(u - 1.0, 0.0)
    r = 2.0 + np.cos(first) + (np.cos(second) - 1.0) / bend
    z = np.sin(first) + np.sin(second) / bend
    return np.stack([r * np.cos(v), r * np.sin(v), z], axis=-1)


def folded(u: Any, v: Any, share: float) -> Any:
    """Return points of two sides of u = 0 that curve to opposite sides for v < share only."""
    x = np.clip(10.0 * (v - share), 0.0, 1.0)
    opposite = 1.0 - x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
    height = opposite * u * np.abs(u) + (1.0 - opposite) * u * u
    return np.stack([u, v, 4.0 * v * v + 0.1 * height], axis=-1)


@pytest.mark.parametrize(
    ("position", "ends", "cells", "joints", "is_joint"),
    [
        (profile, (0.0, 3.5), (32, 8), (1.0, 2.5), True),
        (partial(revolved, jump=0.07), (0.0, 2.2), (64, 8), (1.0,), False),
        (partial(revolved, jump=0.15), (0.0, 2.2), (64, 8), (1.0,), True),
        # A line is a joint if the sign of the curvature changes along most of it.
        (partial(folded, share=0.55), (-1.0, 1.3), (64, 64), (0.0,), False),
        (partial(folded, share=0.8), (-1.0, 1.3), (64, 64), (0.0,), True),
    ],
)
def test_lines_are_half_a_step_from_jumps_of_curvature(position, ends, cells, joints, is_joint):
    surface = gm.Surface.from_callable(position, (ends, (0.0, 1.0)))
    samples = gm.sample(surface, 400, density="aligned", cells=cells)
    columns = np.unique(samples.uv[samples.column >= 0, 0].round(9))
    for u in joints:
        low, high = columns[columns < u], columns[columns > u]
        near = np.array([u - low[-1], high[0] - u])
        half = abs(near / [low[-1] - low[-2], high[1] - high[0]] - 0.5) < 0.03
        assert half.all() == is_joint


# --- steps along the rulings of an exact cylinder -------------------------------------------------


@pytest.mark.kernels
def test_steps_along_the_rulings_of_a_cylinder_do_not_depend_on_rounding() -> None:
    """Across them, steps reach the limit of normals; then it says nothing of those along them."""
    for curvature in np.linspace(0.5, 3.0, 50):
        normal, space = np.zeros((3, 3, 4)), np.zeros((3, 3, 4))
        normal[2], space[2] = curvature, 1e-30
        swapped = (np.ascontiguousarray(x[::-1].swapaxes(1, 2)) for x in (normal, space))
        small, along_u, along_v = np.full(3, 1e-300), np.empty(3), np.empty(4)
        forms = normal, space, small, small, 1.0
        others = *swapped, np.zeros(4), np.zeros(4), 1.0
        limit = 0.01 * curvature
        shared_steps(forms, others, (limit, 1.0), 0.7, 1e-4, 0.5, along_u, along_v)
        np.testing.assert_allclose(along_v, np.sqrt(limit / curvature))
        assert (along_u == 0.5).all()
