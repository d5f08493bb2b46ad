"""The thin runtime: surface → spline → search → samples → files and pictures."""

import lazy_loader

# The namespaces of the package (see ../__init__.pyi), each loaded when it is first asked for.
__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, ["curves", "directions", "errors", "gauss_map", "surfaces"]
)
