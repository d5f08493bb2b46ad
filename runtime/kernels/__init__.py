"""The algorithms that Numba compiles: loops over the formulas of `generated`, in plain Python."""
