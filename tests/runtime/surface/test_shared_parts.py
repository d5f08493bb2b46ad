"""SymPy expressions whose parts are shared: each is visited once, by the points and by the tape."""

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp

LEVELS = 60  # 2^60 parts, if shared ones are counted each time


def nested(levels: int, x: sp.Expr, factor: float) -> sp.Expr:
    """Return x → factor x² + 1/4, applied `levels` times without SymPy's simplification."""
    for _ in range(levels):
        square = sp.Mul(x, x, factor, evaluate=False)
        x = sp.Add(square, sp.Rational(1, 4), evaluate=False)
    return x


@pytest.mark.parametrize("levels", [3, LEVELS])
def test_points_and_tape_are_those_of_the_recursion(levels: int) -> None:
    u, v = sp.symbols("u v", real=True)
    surface = gm.Surface.from_sympy((u, v, nested(levels, u * v, 0.5)), (u, v), ((0, 1), (0, 1)))
    a, b = np.random.default_rng(2).uniform(size=(2, 20))
    z, along = a * b, b
    for _ in range(levels):
        z, along = 0.5 * z * z + 0.25, z * along
    np.testing.assert_allclose(surface.evaluate(a, b)[:, 2], z, rtol=1e-14)
    assert surface.tape is not None
    np.testing.assert_allclose(surface.jets(a, b)[:, 1, 2], along, rtol=1e-12, atol=1e-300)


def test_symbols_of_the_same_name_are_replaced() -> None:
    u, v = sp.symbols("u v")  # not real
    surface = gm.Surface.from_sympy((u, v, nested(LEVELS, u, 0.5)), (u, v), ((0, 1), (0, 1)))
    assert surface.evaluate(0.5, 0.5).shape == (3,)
    with pytest.raises(gm.errors.InputError, match="neither parameter nor number: w"):
        gm.Surface.from_sympy((u, v, nested(LEVELS, sp.Symbol("w"), 0.5)), (u, v), ((0, 1), (0, 1)))
