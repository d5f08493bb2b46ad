"""gaussmap: curvature-dependent sampling of surfaces by their support functions.

import gaussmap as gm

samples = gm.sample(gm.surfaces.torus(major=1.0, minor=0.35), 10_000)
samples.points, samples.normals, samples.gaussian_curvature
samples.write("torus.ply")
"""

import lazy_loader

__version__ = "0.2.0"

# The names are in __init__.pyi, each loaded at first use: the import of SymPy and Numba takes long.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
