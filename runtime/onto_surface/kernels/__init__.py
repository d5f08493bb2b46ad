"""The loops that Numba compiles for moving samples from the spline to the surface."""
