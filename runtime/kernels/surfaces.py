"""The positions of the surfaces of the catalogue, compiled at first use."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from ...generated.surfaces import CATALOGUE
from .jit import jit

__all__ = ["positions"]


@cache
def positions(name: str) -> Callable[..., None]:
    """Return the loop that writes points (k, 3) of a surface.

    Its arguments are the parameters of the surface, u (k,), v (k,), and the points.
    """
    return jit(CATALOGUE[name]["position"])
