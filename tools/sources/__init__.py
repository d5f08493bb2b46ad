"""Texts that name surfaces of the catalogue, formulas, grids, elevations and CAD parts."""
