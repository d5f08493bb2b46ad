"""Exact decisions: splines and normals full of exact ties, against what topology demands."""

import math
from fractions import Fraction
from itertools import product
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search import exact, long_integers
from hypothesis import given
from hypothesis import strategies as st

from ...nets import in_fractions, vectors_of

ALIGNED = np.array([n for n in product((-1.0, 0.0, 1.0), repeat=3) if any(n)])
PERIODIC: Any = (("periodic", "periodic"), ("periodic", "periodic"))
OPEN: Any = (("open", "open"), ("open", "open"))


def torus_of_integers(m: int, n: int, size: int, noise: np.ndarray) -> gm.Spline:
    """A closed spline whose coefficients are small integers: most of its ties are exact."""
    u, v = np.meshgrid(2 * np.pi * np.arange(m) / m, 2 * np.pi * np.arange(n) / n, indexing="ij")
    ring = 2.0 + np.cos(v)
    inner = np.round(size * np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], -1)) + noise
    return gm.Spline(
        np.pad(inner, [(1, 1), (1, 1), (0, 0)], mode="wrap"), ((0, m), (0, n)), PERIODIC, "t"
    )


@given(
    seed=st.integers(0, 2**32 - 1),
    height=st.integers(0, 4),
    size=st.sampled_from([4, 8, 64]),
    cells=st.sampled_from([(8, 8), (12, 10), (10, 6)]),
)
def test_dented_integer_torus(seed: int, height: int, size: int, cells: tuple[int, int]) -> None:
    noise = np.random.default_rng(seed).integers(-height, height + 1, (*cells, 3))
    spline = torus_of_integers(*cells, size, noise if size == 64 else 0 * noise)
    normals = np.concatenate([ALIGNED, gm.icosphere(3)])
    assert (gm.GaussMap(spline).degree(normals) == 0).all()


def integers_of(vectors: np.ndarray) -> np.ndarray:
    """Return each vector (k, 3) times a power of two that makes it integers (3, k)."""
    rows = [[Fraction(x) for x in vector] for vector in vectors.tolist()]
    units = [math.lcm(*(x.denominator for x in row)) for row in rows]
    scaled = [[int(x * unit) for x in row] for row, unit in zip(rows, units, strict=True)]
    return np.array(scaled, dtype=object).T


@pytest.mark.kernels
def test_forms_on_integers_are_those_of_fractions() -> None:
    spline = torus_of_integers(6, 5, 50, np.zeros((6, 5, 3)))
    bits = np.random.default_rng(4).integers(-(2**40), 2**40, spline.coefficients.shape)
    spline.coefficients[...] = bits * 2.0**-50  # a common exponent to find, and exact nets
    vectors, exponent = long_integers.patch_vectors(spline, np.arange(spline.patches))
    unit = Fraction(2) ** exponent / Fraction(spline.scale)
    for patch in range(0, spline.patches, 7):
        expected = 8 * vectors_of(in_fractions(spline.control_nets[patch]))
        assert (vectors[..., patch] * unit == expected).all()


@pytest.mark.kernels
def test_infinitesimal_displacement_agrees_with_a_small_one() -> None:
    """Real displacements in the same order of size give the same signs, for small integers."""
    rng = np.random.default_rng(5)
    n = np.array([[int(x) for x in row] for row in rng.integers(-1, 2, (3, 400))], dtype=object)
    vectors = np.array(
        [[int(x) for x in row] for row in rng.integers(-3, 4, (15, 400))], dtype=object
    ).reshape(5, 3, 400)
    _, signs = long_integers.displaced_forms(vectors, n)
    # In bits: n 64 · 20, ε 16 · 20, 4 · 20 and 20, so that also n ε₃ ≫ ε₁² and ε₁ ε₃ ≫ ε₂².
    shifts = (1 << 320, 1 << 80, 1 << 20)
    moved = np.array([(x << 1280) + e for x, e in zip(n, shifts, strict=True)], dtype=object)
    assert (signs == np.sign(long_integers.exact_forms(vectors, moved)[1:])).all()
    assert (np.sign(long_integers.exact_forms(vectors, n)[1:]) == 0).any()


def every_pair(spline: gm.Spline, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    patches = np.repeat(np.arange(spline.patches), len(normals))
    return patches, np.tile(normals, (spline.patches, 1))


def check_forms(spline: gm.Spline, patches: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Compare the decisions on pairs with those of Python's integers; return the signs."""
    local, size, signs = exact.decided_forms(spline, patches, normals, None)
    expected_local, expected_size, expected = long_integers.forms_of_pairs(spline, patches, normals)
    np.testing.assert_array_equal(signs, expected)
    inside = (signs == signs[:, :1]).all(axis=1) & (signs != 0).all(axis=1)
    vectors, _ = long_integers.patch_vectors(spline, patches)
    regular = inside & (long_integers.exact_forms(vectors, integers_of(normals))[0] != 0)
    np.testing.assert_array_equal(size[regular], expected_size[regular])
    # U and D are rounded once, and their quotient; the integers round it once.
    np.testing.assert_allclose(local[inside], expected_local[inside], rtol=2**-51, atol=0.0)
    return signs


@pytest.fixture
def no_long_integers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nothing but the kernel decide."""
    monkeypatch.setattr(exact, "forms_of_pairs", None)


@pytest.mark.usefixtures("no_long_integers")
@pytest.mark.parametrize("size", [1.0, 0.3, 1e-5, 1e150, 1e-150])
@pytest.mark.quick_for("0.3", "1e+150")
def test_compiled_forms_are_those_of_long_integers(size: float) -> None:
    spline = torus_of_integers(8, 6, 8, np.zeros((8, 6, 3)))
    spline.coefficients[...] *= size
    check_forms(spline, *every_pair(spline, np.concatenate([ALIGNED, gm.icosphere(2)])))


@pytest.mark.usefixtures("no_long_integers")
@pytest.mark.parametrize("count", [2_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_random_pairs_are_decided_as_on_long_integers(count: int) -> None:
    rng = np.random.default_rng(7)
    coefficients = rng.standard_normal((18, 18, 3)) * 2.0 ** rng.integers(-20, 20, (18, 18, 1))
    spline = gm.Spline(coefficients, ((0, 16), (0, 16)), OPEN, "t")
    normals = rng.standard_normal((count, 3)) * 2.0 ** rng.integers(-50, 50, (count, 3))
    signs = check_forms(spline, rng.integers(0, spline.patches, count), normals)
    assert len(np.unique(signs, axis=0)) == 8


@pytest.mark.usefixtures("no_long_integers")
@pytest.mark.parametrize("count", [2_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_symmetric_pairs_are_decided_as_on_long_integers(count: int) -> None:
    """Small integers, among which each of the ten monomials decides some sign."""
    rng = np.random.default_rng(8)
    coefficients = rng.integers(-1, 2, (42, 42, 3)).astype(np.float64)
    coefficients[20:] *= rng.integers(0, 2, (22, 42, 3))  # many zeros, and developable patches
    spline = gm.Spline(coefficients, ((0, 40), (0, 40)), OPEN, "t")
    patches = rng.integers(0, spline.patches, count)
    normals = rng.integers(-2, 3, (count, 3)).astype(np.float64)
    normals[~normals.any(axis=1)] = 1.0
    check_forms(spline, patches, normals)
    vectors, _ = long_integers.patch_vectors(spline, patches[:2_000])
    n = integers_of(normals[:2_000])
    nonzero = np.asarray(long_integers.monomials_of_forms(vectors, n) != 0, dtype=bool)
    first = np.where(nonzero.any(axis=0), np.argmax(nonzero, axis=0), -1)
    tied = ~nonzero[0, 1:].all(axis=0)
    assert set(first[1:, tied].ravel().tolist()) >= set(range(10))


@pytest.mark.usefixtures("no_long_integers")
def test_the_largest_numbers_do_not_overflow() -> None:
    """All bits are set, and the exponents differ as far as they may: 69 and 133."""
    rng = np.random.default_rng(9)

    def extreme(shape: tuple[int, ...], shift: int) -> np.ndarray:
        full = rng.choice([-1.0, 1.0], shape) * (2.0 - 2.0**-52)
        return np.where(rng.random(shape) < 0.8, full * 2.0**shift, rng.choice([-1.0, 1.0], shape))

    spline = gm.Spline(extreme((18, 18, 3), 69), ((0, 16), (0, 16)), OPEN, "t")
    pairs = rng.integers(0, spline.patches, 2_000), extreme((2_000, 3), 133)
    check_forms(spline, *pairs)
    spline.coefficients[:, :, 0] *= 2.0
    with pytest.raises(TypeError):
        check_forms(spline, *pairs)


@pytest.mark.kernels
def test_numbers_too_long_for_the_kernel_are_long_integers() -> None:
    spline = torus_of_integers(8, 6, 8, np.zeros((8, 6, 3)))
    spline.coefficients[3, 3] *= 1e-200
    check_forms(spline, *every_pair(spline, np.array([[1.0, 0.0, 0.0], [1.0, 1e-170, 1e-290]])))
