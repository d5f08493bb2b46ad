"""Algorithms in plain Python that Numba compiles: loops over the formulas of `generated`."""
