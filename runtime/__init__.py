"""The thin runtime: surface → spline → search → samples → files and pictures."""
