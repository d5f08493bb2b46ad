"""Everything built on the runtime: theory, meshes, parts, files, pictures, data sets, commands."""

import lazy_loader

# The namespaces of the package (see ../__init__.pyi), each loaded on first access.
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["curves", "gauss_map"])
