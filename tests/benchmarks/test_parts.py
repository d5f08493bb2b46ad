"""The page about the quality of parts, from errors that nobody measured."""

import itertools

import numpy as np
from gaussmap.benchmarks.parts.measure import Errors, OnPart, errors
from gaussmap.benchmarks.parts.page import page
from gaussmap.benchmarks.parts.reference import Reference
from gaussmap.benchmarks.parts.ways import BALANCED, FARTHEST, GMSH, WAYS, Cloud, within


def test_page_names_losses_first_and_judges_targets():
    own, other = Errors(100, 2.0, 2.5, 5.0, 9.0), Errors(102, 1.9, 2.0, 10.0, 8.0)
    found = dict.fromkeys(WAYS, other) | {BALANCED: own, GMSH: "fails: no mesh"}
    tuned = OnPart("a.step", 7, 100, held_out=False, found=found)
    held = OnPart("b.step", 9, 100, held_out=True, found=dict.fromkeys(WAYS, own))
    text = page([tuned, held])
    losses = text[: text.index("## What is measured")]
    assert "- Farthest points have smaller gaps on `a.step` (1.05 ×)." in losses
    assert "- Farthest points have smaller gaps on the same side on `a.step` (1.25 ×)." in losses
    assert "- Farthest points have a smaller mean E on `a.step` (1.12 ×)." in losses
    assert "smaller angles" not in losses
    assert "Gmsh" not in losses
    assert "fails: no mesh" in text
    assert "not known" in text
    assert "1.05 met" in text
    assert "0.50 met" in text
    assert "`b.step`, 9 faces, **held out**" in text


def test_errors_are_those_of_places():
    places = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]])
    tilted = np.array([0.0, np.sin(0.1), np.cos(0.1)])
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], tilted])
    reference = Reference(places, normals, np.array([1.0, 1.0, 2.0]), 5.0)
    up = np.array([[[0.0, 0.0, -1.0]], [[0.0, 0.0, 1.0]]])
    found = errors(reference, Cloud(places[:2], up))
    assert found.count == 2
    np.testing.assert_allclose((found.gap, found.normal), (80.0, np.degrees(0.1)))
    np.testing.assert_allclose(found.mean, np.degrees(0.1) / 2)
    np.testing.assert_allclose(found.side, 80.0)
    both = np.concatenate([up, np.full((2, 1, 3), np.nan)], axis=1)
    both[1, 1] = tilted
    assert errors(reference, Cloud(places[:2], both)).normal < 1e-6
    assert FARTHEST in WAYS


def test_samples_on_the_other_side_of_a_wall_do_not_count():
    places = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [4.0, 0.0, 0.1]])
    normals = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    reference = Reference(places, normals, np.ones(3), 5.0)
    cloud = Cloud(places[[0, 2]], np.array([[[0.0, 0.0, 1.0]], [[0.0, 0.0, 1.0]]]))
    found = errors(reference, cloud)
    np.testing.assert_allclose((found.gap, found.side), (2.0, 80.0))
    assert errors(reference, Cloud(places[:1], normals[:1, None])).side == np.inf


def test_what_takes_too_long_is_given_up():
    assert within(1, sum, itertools.repeat(0)) is None
    assert within(60, abs, -3) == 3
