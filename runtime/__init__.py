"""The thin runtime: from a surface and normals to points (`map.GaussMap`)."""

import lazy_loader

# The namespaces of the package (see ../__init__.pyi), each imported at first use.
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["directions"])
