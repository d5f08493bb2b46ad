"""The loops that Numba compiles for choosing samples."""
