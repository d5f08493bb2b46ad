"""CAD parts: what is read of STEP, IGES and BREP files, kept as arrays, and sampled."""
