"""The mathematics of gaussmap in SymPy: derived once, exactly, and printed as kernels and LaTeX.

`formulas` holds every formula by its name. `BezierTriangle` does the algebra for one given patch.
"""

import lazy_loader

# The names are in __init__.pyi: reading a user's text takes no derivation.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
