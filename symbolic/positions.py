"""The positions of parametric surfaces as formulas."""

from __future__ import annotations

from .formula import Formula
from .surfaces import ParametricSurface

__all__ = ["position"]


def position(surface: ParametricSurface) -> Formula:
    """Return x(u,v) of a surface as a formula of u, v and its parameters."""
    return Formula.build(
        surface.name,
        surface.sentence,
        inputs=[surface.u, surface.v, *surface.defaults],
        outputs=list(zip(("x_x", "x_y", "x_z"), surface.position, strict=True)),
    )
