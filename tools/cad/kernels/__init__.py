"""The loops that Numba compiles for faces of CAD parts."""
