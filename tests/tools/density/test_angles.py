"""Normals far from each other."""

import gaussmap as gm
import numpy as np
from gaussmap.tools.density.angles import choose_apart
from scipy.spatial import KDTree


def test_normals_are_chosen_far_from_known_ones():
    known, normals = gm.icosphere(3), gm.fibonacci(2000)
    near, widest = 0.1, 1.0
    chosen = choose_apart(np.concatenate([normals, np.zeros((1, 3))]), near, 1, widest, None, known)
    every = np.concatenate([known, normals[chosen]])
    distances, _ = KDTree(every).query(normals, k=2)
    assert distances[:, 0].max() <= near
    assert distances[chosen, 1].min() > near * 0.98
