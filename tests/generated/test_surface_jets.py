"""The derivatives of the surfaces of the catalogue, against SymPy."""

import numpy as np
import pytest
import sympy as sp
from gaussmap.generated.surface_jets import JETS
from gaussmap.symbolic.surfaces import CATALOGUE


@pytest.mark.parametrize("surface", CATALOGUE.values(), ids=CATALOGUE)
def test_generated_derivatives_are_those_of_sympy(surface):
    """As plain Python, without compilation."""
    rng = np.random.default_rng(0)
    u, v = (rng.uniform(float(low), float(high), 12) for low, high in surface.domain)
    values = {p.symbol: sp.Rational(p.default) for p in surface.parameters}
    x = sp.Matrix(surface.position).subs(values)
    a, b = surface.u, surface.v
    orders = ((), (a,), (b,), (a, a), (a, b), (b, b))
    rows = [x.diff(*by).flat() if by else x.flat() for by in orders]
    f = sp.lambdify((a, b), rows)
    expected = np.array([f(*place) for place in zip(u, v, strict=True)], float)
    found = np.full((len(u), 6, 3), np.nan)
    JETS[surface.name](*(float(p.default) for p in surface.parameters), u, v, found)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)
