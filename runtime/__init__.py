"""The thin runtime: surface → spline → search → place → density → samples."""

import lazy_loader

# The namespaces of the package (see ../__init__.pyi), each imported at first use.
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["directions"])
