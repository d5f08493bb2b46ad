"""Components of the points with one normal that are not regular."""

from typing import Any

import numpy as np
import pytest
from gaussmap.runtime.proof.components import boxes_of, components_of
from gaussmap.runtime.proof.kernels.answers import KINDS, Answers

OPEN, CURVE = KINDS.index("open"), KINDS.index("curve")
# u from 0 to 1 and v from 0 to 2, u with a period.
DOMAIN = np.array([0.0, 1.0, 0.0, 2.0, 1.0, 0.0])


def answers(*boxes: tuple[int, int, list[float]]) -> Answers:
    """Return answers with boxes: number of the normal, kind, u₀, u₁, v₀, v₁."""
    numbers, kinds, sides = (np.array(x) for x in zip(*boxes, strict=True))
    middles = sides.reshape(-1, 2, 2).mean(axis=2)
    rows = np.column_stack([sides, np.zeros(len(sides)), middles])
    return Answers.new(0)._replace(open_boxes=rows, kinds=kinds, open_numbers=numbers)


APART = [[0.1, 0.2, 0.5, 0.6], [0.4, 0.5, 0.5, 0.6]]
LINES = [[0.1, 0.1, 0.0, 0.9], [0.1, 0.1, 1.0, 2.0]]
ENDS = [[0.1, 0.2, 0.0, 0.1], [0.1, 0.2, 1.9, 2.0]]
JOINED: dict[str, tuple[list[list[float]], list[list[float]]]] = {
    "touching": ([[0.1, 0.2, 0.5, 0.6], [0.2, 0.3, 0.5, 0.6]], [[0.1, 0.3, 0.5, 0.6]]),
    "at a corner": ([[0.1, 0.2, 0.5, 0.6], [0.2, 0.3, 0.6, 0.7]], [[0.1, 0.3, 0.5, 0.7]]),
    "apart": (APART, APART),
    "lines closer than they are long": (LINES, LINES),
    "over the seam": ([[0.9, 1.0, 0.5, 0.6], [0.0, 0.1, 0.5, 0.6]], [[-0.1, 0.1, 0.5, 0.6]]),
    "no seam": (ENDS, ENDS),
    "a chain": (
        [[0.1, 0.2, 0.1, 0.2], [0.5, 0.6, 0.1, 0.2], [0.2, 0.5, 0.1, 0.2]], [[0.1, 0.6, 0.1, 0.2]]
    ),
    "around": (
        [[0.0, 0.4, 0.1, 0.2], [0.4, 0.8, 0.1, 0.2], [0.8, 1.0, 0.1, 0.2]], [[0.0, 1.0, 0.1, 0.2]]
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", JOINED)
def test_boxes_of_one_normal_that_touch_are_joined(name: str) -> None:
    boxes, expected = JOINED[name]
    for order in (boxes, boxes[::-1]):
        found = components_of(boxes_of([answers(*((5, CURVE, x) for x in order))]), DOMAIN)
        np.testing.assert_allclose(found.boxes, expected, rtol=0.0, atol=1e-15)
        assert set(found.kinds) == {CURVE}
        # The points of curves are those of the search.
        middles = np.reshape(boxes, (-1, 2, 2)).mean(axis=2)
        assert (np.abs(found.uv[:, None] - middles).max(axis=2).min(axis=1) < 1e-15).all()


@pytest.mark.parametrize(("width", "kind"), [(1e-6, CURVE), (1e-5, OPEN)])
def test_tiny_open_boxes_at_the_end_of_a_curve_belong_to_it(width: float, kind: int) -> None:
    boxes = [(0, OPEN, [0.1, 0.1, 0.9, 0.9 + 2.0 * width]), (0, CURVE, [0.1, 0.1, 0.0, 0.9])]
    for order in (boxes, boxes[::-1]):
        found = components_of(boxes_of([answers(*order)]), DOMAIN)
        np.testing.assert_array_equal(found.kinds, kind)
        np.testing.assert_array_equal(found.uv, [[0.1, 0.45]] if kind == CURVE else found.uv)


def test_components_are_those_of_one_normal_and_kind() -> None:
    one: Any = [0.1, 0.2, 0.5, 0.6]
    boxes = boxes_of([answers((2, CURVE, one)), answers((1, OPEN, one), (2, OPEN, one))])
    found = components_of(boxes, DOMAIN)
    np.testing.assert_array_equal(found.numbers, [1, 2])
    np.testing.assert_array_equal(found.kinds, OPEN)
    assert len(components_of(boxes_of([]), DOMAIN).numbers) == 0
