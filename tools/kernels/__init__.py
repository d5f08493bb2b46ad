"""Compiled loops of the tools, as those of `runtime/kernels/`."""
