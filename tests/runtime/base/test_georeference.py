"""Single precision far from the origin: when a warning helps."""

import numpy as np
import pytest
from gaussmap.runtime.base.georeference import warn_of_rounding


def test_points_that_rounding_moves_by_much() -> None:
    points = np.array([[4e6, 0.0, 0.0], [4e6, 1.0, 0.0], [4e6, 1.0, 1.0]])
    with pytest.warns(UserWarning, match=r"rounds these .* to 0.25; .*origin such as 4000000"):
        warn_of_rounding(points, 1)
    warn_of_rounding(points - points[0], 1)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_points_tell_nothing_about_distances(count: int) -> None:
    warn_of_rounding(np.array([[4e6, 0.0, 0.0], [4e6, 1.0, 0.0]])[:count], 1)
