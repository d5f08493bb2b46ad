"""The loops that Numba compiles for trims."""
