"""The positions and derivatives of the surfaces of the catalogue, compiled at first use."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from ....generated.surface_jets import JETS
from ....generated.surfaces import CATALOGUE
from ...machine_code.jit import jit


@cache
def positions(name: str) -> Callable[..., None]:
    """Return the compiled loop that writes points (k, 3) of a surface of the catalogue.

    Its arguments are the parameters of the surface, u (k,), v (k,), and the points.
    """
    return jit(CATALOGUE[name]["position"])


@cache
def jets(name: str) -> Callable[..., None]:
    """Return the compiled loop that writes 2-jets (k, 6, 3): x, x_u, x_v, x_uu, x_uv, x_vv.

    Its arguments are the parameters of the surface, u (k,), v (k,), and the jets.
    """
    return jit(JETS[name])
