"""The loops that Numba compiles for searching a spline."""
