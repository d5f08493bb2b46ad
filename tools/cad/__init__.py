"""CAD parts: reading STEP, IGES and BREP files, keeping their faces as arrays, and sampling."""
