"""The steps of graded grids where one of the forms is that of an exact cylinder."""

import numpy as np
from gaussmap.tools.density.kernels.steps import shared_steps


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
