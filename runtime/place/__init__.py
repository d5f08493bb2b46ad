"""From the spline to the surface: where samples are, and what is known of them there."""
