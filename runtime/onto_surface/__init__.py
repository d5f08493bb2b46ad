"""From the spline to the surface: samples are moved to it and evaluated on it."""
