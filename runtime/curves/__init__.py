"""Planar curves (paper, Sect. 4.1): fitting, sampling by normals, polygons."""
