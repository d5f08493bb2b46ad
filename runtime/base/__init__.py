"""The base of all folders: errors, checks of arguments, threads, tolerances, texts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["errors"])
