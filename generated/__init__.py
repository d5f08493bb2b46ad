"""Kernels and formulas written by `make generate`: never edit these."""
