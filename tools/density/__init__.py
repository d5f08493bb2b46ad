"""Samples with a target density: at normals of lattices, on grids, and in the gaps between them."""
