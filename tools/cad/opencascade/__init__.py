"""Code of the process that reads CAD files, with Open CASCADE and NumPy only."""
