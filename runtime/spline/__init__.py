"""Splines of quadratic patches, of grids and points."""
