"""The loops that Numba compiles for Gaussian images."""
