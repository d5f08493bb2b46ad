"""Machine code of kernels: shipped with the package, or compiled here and cached."""
