"""The loops that Numba compiles for the proof."""
