"""Dividing a count."""

import numpy as np
import pytest
from gaussmap.tools.density.shares import apportioned


@pytest.mark.parametrize(
    ("count", "weights", "parts"),
    [(10, [1.0, 1.0], [5, 5]), (11, [2.0, 1.0, 1.0], [5, 3, 3]), (10, [1e9, 1.0, 0.0], [10, 0, 0]),
     (0, [1.0, 2.0], [0, 0]), (2, [1.0, 5.0, 3.0], [0, 1, 1])],
)  # fmt: skip
def test_parts_of_a_count(count, weights, parts):
    found = apportioned(count, np.array(weights))
    assert found.sum() == count
    assert np.abs(found - parts).max() <= 1
