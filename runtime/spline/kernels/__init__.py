"""The loops that Numba compiles for the spline."""
