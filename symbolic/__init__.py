"""The mathematics of gaussmap in SymPy: derived once, exactly, and printed as kernels and LaTeX.

`formulas` holds every formula by its name. `BezierTriangle` does the algebra for one given patch.
"""

import lazy_loader

# The names are loaded as __init__.pyi lists them, when they are first used: reading a user's text
# must not derive formulas.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
