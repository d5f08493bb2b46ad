"""Points of a surface near those of its spline: Newton's method, regular charts at poles."""
