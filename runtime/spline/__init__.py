"""Splines of quadratic patches, on grids of cells and on triangulations."""
