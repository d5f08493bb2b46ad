"""The search: every point of a spline at given normals, each exactly once."""
