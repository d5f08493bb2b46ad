"""Fitting splines to surfaces: the choice of cells, and the remaining error."""
