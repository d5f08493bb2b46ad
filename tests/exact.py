"""Surfaces of the catalogue by their formulas, evaluated by NumPy."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp
from gaussmap.symbolic.surfaces import CATALOGUE

from .shapes import Array, unit


@dataclass(frozen=True, eq=False)
class Exact:
    """The exact surface at places (k, 2), with its default parameters or others."""

    name: str
    parameters: Mapping[str, float] | None = None

    def _values(self, expressions: tuple[sp.Expr, ...], uv: Array) -> Array:
        surface = CATALOGUE[self.name]
        changed = self.parameters or {}
        chosen = {x.symbol: changed.get(x.symbol.name, x.default) for x in surface.parameters}
        exact = [sp.sympify(e).xreplace(chosen) for e in expressions]
        function = sp.lambdify((surface.u, surface.v), exact, "numpy", cse=True)
        return np.stack([np.broadcast_to(x, len(uv)) for x in function(*uv.T)], axis=-1)

    def points(self, uv: Array) -> Array:
        return self._values(CATALOGUE[self.name].position, uv)

    def normals(self, uv: Array) -> Array:
        return unit(self._values(CATALOGUE[self.name].normal_field, uv))

    def curvatures(self, uv: Array) -> Array:
        surface = CATALOGUE[self.name]
        return self._values((surface.gaussian_curvature, surface.mean_curvature), uv)
