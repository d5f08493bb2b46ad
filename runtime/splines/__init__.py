"""From values on a grid to C¹ quadratic splines: domains, boundary conditions, missing values."""
