from __future__ import annotations

import numpy as np
import pytest
from gaussmap.tools.pictures.scene import view
from gaussmap.tools.pictures.sphere_half import view_of


@pytest.mark.parametrize("mean", [(0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 0, -1), None])
def test_the_view_of_the_sphere(mean: tuple[float, float, float] | None) -> None:
    vectors = np.array([-view()[2] if mean is None else mean], dtype=float)
    seen_from = view_of(vectors)
    np.testing.assert_allclose(seen_from @ seen_from.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(seen_from) == pytest.approx(1.0)
    np.testing.assert_allclose(seen_from[2], vectors[0] if vectors.any() else view()[2], atol=1e-12)
