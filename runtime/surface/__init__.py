"""Surfaces that people bring: formulas, functions, grids, NURBS; derivatives, trims, motions."""
