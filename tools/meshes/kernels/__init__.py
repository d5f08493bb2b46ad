"""The loops that Numba compiles for meshes."""
