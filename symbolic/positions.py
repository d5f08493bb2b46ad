"""The positions of parametric surfaces as formulas."""

from __future__ import annotations

from .formula import BEYOND_THE_PAPER, Formula
from .notation import vectors
from .surfaces import ParametricSurface

__all__ = ["position"]


def position(surface: ParametricSurface) -> Formula:
    """Return x(u,v) of a surface as a formula of u, v and its parameters."""
    (x,) = vectors("x")
    return Formula(
        surface.name,
        surface.sentence,
        BEYOND_THE_PAPER,
        (surface.u, surface.v, *surface.defaults),
        tuple(zip(x.components, surface.position, strict=True)),
        (x,),
    )
