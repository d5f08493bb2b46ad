"""What runs in the process of its own that reads CAD files: Open CASCADE and NumPy only."""
