"""Surfaces from texts: names of the catalogue, formulas, files of grids, elevations and parts."""
