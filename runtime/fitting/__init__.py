"""Fitting splines to surfaces: the choice of cells, and the error that is left."""
