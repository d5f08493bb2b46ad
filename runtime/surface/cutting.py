"""The smooth pieces of a surface between its creases."""

from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

from ..domain.domain import Boundary, BoundaryPair, Domain, Interval
from .derivatives import Differentiable
from .moved import Moved
from .surface_values import SurfaceValues

Surface = TypeVar("Surface", bound=SurfaceValues)


def pieces_of(surface: Surface) -> tuple[Surface, ...]:
    """Return the smooth pieces of a surface, cut along its creases; (surface,) if it is smooth."""
    function = surface.function
    if isinstance(function, Moved):
        return _moved_pieces(surface, function)
    if not isinstance(function, Differentiable) or not any(function.creases):
        return (surface,)
    along_u, along_v = (
        list(pairwise((low, *lines, high)))
        for (low, high), lines in zip(surface.domain, function.creases, strict=True)
    )
    domains = [(u, v) for u in along_u for v in along_v]
    return tuple(_piece(surface, function, k, domain) for k, domain in enumerate(domains))


def _moved_pieces(surface: Surface, moved: Moved) -> tuple[Surface, ...]:
    """Return the pieces of a moved surface: the moved pieces of the original surface."""
    pieces = pieces_of(moved.surface)
    if len(pieces) == 1:
        return (surface,)
    after = sorted((_moved(surface, moved, x) for x in pieces), key=lambda x: x.domain)
    return tuple(replace(x, name=f"{x.name} (piece {k + 1})") for k, x in enumerate(after))


def _moved(surface: Surface, moved: Moved, piece: SurfaceValues) -> Surface:
    """Return the piece of a moved surface that is the image of `piece` of the original surface."""
    (low, high), along_v = piece.domain
    (at_low, at_high), ends_v = piece.boundary
    if moved.turned:
        low, high = sum(moved.ends) - high, sum(moved.ends) - low
        at_low, at_high = at_high, at_low
    return replace(
        surface,
        function=replace(moved, surface=piece),
        domain=((low, high), along_v),
        boundary=((at_low, at_high), ends_v),
    )


def _piece(surface: Surface, function: Differentiable, number: int, domain: Domain) -> Surface:
    """Return piece `number` of a surface, the part of the surface over `domain`."""
    return replace(
        surface,
        name=f"{surface.name} (piece {number + 1})",
        function=function.restricted(domain),
        domain=domain,
        boundary=_boundary(surface, domain),
    )


def _boundary(surface: SurfaceValues, domain: Domain) -> Boundary:
    """Return the boundary conditions of the piece over `domain`: sides made by cuts are open."""
    along_u, along_v = (
        _ends(*x) for x in zip(surface.boundary, surface.domain, domain, strict=True)
    )
    if along_u != ("periodic", "periodic") and "pole" in along_v:
        along_v = ("open", "open")  # a sector of the surface around the pole
    return along_u, along_v


def _ends(ends: BoundaryPair, whole: Interval, part: Interval) -> BoundaryPair:
    if part == whole:
        return ends
    low, high = (x == y and end == "pole" for x, y, end in zip(whole, part, ends, strict=True))
    return "pole" if low else "open", "pole" if high else "open"
