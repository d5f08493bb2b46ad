"""What samples lie on: a spline, or the surface that it approximates."""
