"""The loops that Numba compiles for normals and vectors."""
