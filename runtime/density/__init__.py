"""Densities that normals alone do not give: samples that come near every point of a surface."""
