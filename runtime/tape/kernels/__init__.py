"""The loops that Numba compiles for tapes."""
