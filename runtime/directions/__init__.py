"""Sets of directions on the sphere and on the circle, subsets of them, and covering radii."""

from .covering import covering_radius
from .regions import cap, polygon
from .sets import circle, fibonacci, healpix, icosphere, random

__all__ = [
    "cap",
    "circle",
    "covering_radius",
    "fibonacci",
    "healpix",
    "icosphere",
    "polygon",
    "random",
]


def __dir__() -> list[str]:
    return __all__
