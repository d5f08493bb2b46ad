"""What is made with the runtime: theory, meshes, parts, files, pictures, data sets, commands."""

import lazy_loader

# The namespaces of the package (see ../__init__.pyi), each loaded when it is first asked for.
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["curves", "gauss_map"])
