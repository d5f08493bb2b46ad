"""From the spline to the surface: samples are moved to the surface and evaluated there."""
