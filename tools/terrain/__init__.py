"""Elevations as surfaces: rasters, coordinates, and reference systems."""
