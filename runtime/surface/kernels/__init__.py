"""The loops that Numba compiles for surfaces of the catalogue."""
