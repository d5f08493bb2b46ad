"""The positions of parametric surfaces, and their derivatives, as formulas."""

from .formula import BEYOND_THE_PAPER, Content, Formula
from .notation import vectors
from .surfaces import ParametricSurface


def position(surface: ParametricSurface) -> Formula:
    """Return x(u,v) of a surface as a formula of u, v and its parameters."""
    (x,) = vectors("x")
    content = Content(
        (surface.u, surface.v, *surface.defaults),
        tuple(zip(x.components, surface.position, strict=True)),
        (x,),
    )
    return Formula(surface.name, surface.sentence, BEYOND_THE_PAPER, lambda: content)


def surface_jet(surface: ParametricSurface) -> Formula:
    """Return the 2-jet of a surface: x(u,v) and its derivatives up to the second."""
    u, v = surface.u, surface.v
    orders = {"x": (), "x_u": (u,), "x_v": (v,), "x_uu": (u, u), "x_uv": (u, v), "x_vv": (v, v)}
    outputs = vectors(orders)
    definitions = tuple(
        pair
        for x, by in zip(outputs, orders.values(), strict=True)
        for pair in zip(x.components, surface.derivative(*by).flat(), strict=True)
    )
    sentence = "Position and derivatives x, x_u, x_v, x_uu, x_uv, x_vv of the surface of this name."
    content = Content((u, v, *surface.defaults), definitions, outputs)
    return Formula(surface.name, sentence, BEYOND_THE_PAPER, lambda: content)
