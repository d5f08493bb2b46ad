"""Whether vectors have unit length."""

import gaussmap as gm
import numpy as np
from gaussmap.runtime.directions.kernels.unit import are_unit


def test_no_unit_vector():
    normals = gm.icosphere(2)
    for bad in (np.nan, np.inf, -2.0):
        spoilt = normals.copy()
        spoilt[7, 1] = bad
        assert not are_unit(spoilt, 0, len(spoilt))
        assert are_unit(spoilt, 0, 7)
