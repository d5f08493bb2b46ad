"""Exact decisions: splines and normals full of exact ties, against what topology demands."""

from fractions import Fraction
from itertools import product

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.generated.primes import PRIMES
from gaussmap.generated.spline import NEIGHBOURS, TRIANGLE_NEIGHBOURS, triangle
from gaussmap.generated.vectors import Vector
from gaussmap.runtime import exact, long_integers
from gaussmap.runtime.formula_calls import python_function, vector
from gaussmap.runtime.integers import integers, sign
from gaussmap.runtime.kernels import decide, modular
from gaussmap.runtime.kernels.jit import jit
from gaussmap.runtime.splines.domain import Boundary
from hypothesis import given
from hypothesis import strategies as st

ALIGNED = np.array([n for n in product((-1.0, 0.0, 1.0), repeat=3) if any(n)])
PERIODIC: Boundary = (("periodic", "periodic"), ("periodic", "periodic"))
OPEN: Boundary = (("open", "open"), ("open", "open"))
precise_forms = jit(python_function(decide.precise_forms))
mixed_radix_value = jit(python_function(modular.mixed_radix_value))


def torus_of_integers(m: int, n: int, size: int, noise: np.ndarray) -> gm.Spline:
    """A closed spline whose coefficients are small integers: most of its ties are exact."""
    u, v = np.meshgrid(2 * np.pi * np.arange(m) / m, 2 * np.pi * np.arange(n) / n, indexing="ij")
    ring = 2.0 + np.cos(v)
    inner = np.round(size * np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], -1)) + noise
    return gm.Spline(
        np.pad(inner, [(1, 1), (1, 1), (0, 0)], mode="wrap"), ((0, m), (0, n)), PERIODIC, "t"
    )


def sign_sums(spline: gm.Spline, normals: np.ndarray) -> np.ndarray:
    samples = gm.sample(spline, normals=normals)
    signs = np.where(samples.elliptic, 1, -1)
    return np.bincount(samples.normal_index, weights=signs, minlength=len(normals))


@pytest.mark.compiled
@pytest.mark.parametrize("size", [4, 8, 64])
@pytest.mark.parametrize("cells", [(8, 8), (12, 8), (16, 12), (10, 6)])
def test_integer_torus(size: int, cells: tuple[int, int]) -> None:
    spline = torus_of_integers(*cells, size, np.zeros((*cells, 3)))
    normals = np.concatenate([ALIGNED, gm.icosphere(4)])
    assert (sign_sums(spline, normals) == 0).all()


@pytest.mark.compiled
@given(seed=st.integers(0, 2**32 - 1), height=st.integers(0, 4))
def test_dented_integer_torus(seed: int, height: int) -> None:
    noise = np.random.default_rng(seed).integers(-height, height + 1, (12, 10, 3))
    spline = torus_of_integers(12, 10, 64, noise)
    normals = np.concatenate([ALIGNED, gm.icosphere(3)])
    assert (sign_sums(spline, normals) == 0).all()


def test_forms_on_integers_are_those_of_fractions() -> None:
    spline = torus_of_integers(6, 5, 50, np.zeros((6, 5, 3)))
    spline.coefficients[...] *= 0.3  # no integers any more, and a common exponent to find
    patches = np.arange(spline.patches)
    vectors, exponent = long_integers._patch_vectors(spline, patches)
    unit = Fraction(2) ** exponent / Fraction(spline.scale)
    for patch in patches[::7]:
        cell, turn = divmod(int(patch), 4)
        i, j = divmod(cell, spline.cells[1])
        around = [
            [Fraction(float(x)) for x in spline.coefficients[i + 1 + di, j + 1 + dj]]
            for di, dj in NEIGHBOURS[turn]
        ]
        read = np.array([around[k] for k in TRIANGLE_NEIGHBOURS]) - np.array(around[4])
        expected = python_function(triangle)(*map(vector, read))[:5]
        assert (vectors[..., patch] * unit == np.array(expected)).all()


def test_infinitesimal_displacement_agrees_with_a_small_one() -> None:
    """Real displacements in the same order of size give the same signs, for small integers."""
    rng = np.random.default_rng(5)
    n = np.array([[int(x) for x in row] for row in rng.integers(-1, 2, (3, 400))], dtype=object)
    vectors = np.array(
        [[int(x) for x in row] for row in rng.integers(-3, 4, (15, 400))], dtype=object
    ).reshape(5, 3, 400)
    _, signs = long_integers._displaced_forms(vectors, n)
    # In bits: n 64 · 20, ε 16 · 20, 4 · 20 and 20, so that also n ε₃ ≫ ε₁² and ε₁ ε₃ ≫ ε₂².
    shifts = (1 << 320, 1 << 80, 1 << 20)
    moved = np.array([(x << 1280) + e for x, e in zip(n, shifts, strict=True)], dtype=object)
    assert (signs == sign(long_integers._forms(vectors, moved)[1:])).all()
    assert (sign(long_integers._forms(vectors, n)[1:]) == 0).any()


def every_pair(spline: gm.Spline, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    patches = np.repeat(np.arange(spline.patches), len(normals))
    return patches, np.tile(normals, (spline.patches, 1))


def decided(
    spline: gm.Spline, patches: np.ndarray, normals: np.ndarray, bound: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the compiled decision says of pairs if the forms are known up to `bound`."""
    bounds = np.full(len(patches), bound)
    return exact._forms(spline, patches, normals, bounds, np.ones(len(patches)), None)


@pytest.mark.compiled
@pytest.mark.parametrize("bound", [1e-13, np.inf])
@pytest.mark.parametrize("size", [1.0, 0.3, 1e-5, 1e150, 1e-150])
def test_compiled_forms_are_those_of_long_integers(size: float, bound: float) -> None:
    """With an infinite bound nothing but integers modulo primes decides."""
    spline = torus_of_integers(8, 6, 8, np.zeros((8, 6, 3)))
    spline.coefficients[...] *= size
    pairs = every_pair(spline, np.concatenate([ALIGNED, gm.icosphere(3)]))
    local, length, signs = decided(spline, *pairs, bound)
    expected_local, expected_length, expected_signs = long_integers.forms_of_pairs(spline, *pairs)
    np.testing.assert_array_equal(signs, expected_signs)
    inside = (signs == signs[:, :1]).all(axis=1) & (signs != 0).all(axis=1)
    # U/D is rounded once by the integers; modulo primes after sums of at most 24 positive terms.
    np.testing.assert_allclose(local[inside], expected_local[inside], rtol=2**-46, atol=0.0)
    np.testing.assert_allclose(length[inside], expected_length[inside], rtol=2**-46)


@pytest.mark.compiled
def test_numbers_too_long_for_the_primes_are_long_integers() -> None:
    spline = torus_of_integers(8, 6, 8, np.zeros((8, 6, 3)))
    spline.coefficients[3, 3] *= 1e-200
    patches, normals = every_pair(spline, np.array([[1.0, 0.0, 0.0], [1.0, 1e-170, 1e-290]]))
    _, _, signs = decided(spline, patches, normals, np.inf)
    expected = long_integers.forms_of_pairs(spline, patches, normals)[2]
    np.testing.assert_array_equal(signs, expected)


def test_double_doubles_carry_106_bits() -> None:
    """Forms of random patches, against fractions: the error that the kernel allows for."""
    rng = np.random.default_rng(3)
    spline = gm.Spline(rng.standard_normal((4, 4, 3)), ((0, 2), (0, 2)), OPEN, "t")
    for patch, n in zip(range(16), gm.fibonacci(16), strict=True):
        i, j = divmod(patch // 4, 2)
        forms = precise_forms(
            spline.coefficients, i + 1, j + 1, patch % 4, spline.scale, Vector(*n)
        )
        vectors, exponent = long_integers._patch_vectors(spline, np.array([patch]))
        whole, unit = integers(n)
        exact_forms = long_integers._forms(vectors, whole[:, None])[:, 0]
        scale = Fraction(2) ** (2 * (exponent + unit))
        size = max(abs(int(x)) * scale for x in exact_forms)
        for (high, low), value in zip(forms, exact_forms, strict=True):
            error = abs(Fraction(high) + Fraction(low) - int(value) * scale)
            # 40 operations in a row at most, each with an error of 2⁻¹⁰² of sums of 12 moduli.
            assert error <= 40 * 12 * Fraction(2) ** -102 * max(size, 1)


@given(values=st.lists(st.integers(-(2**200), 2**200), min_size=1, max_size=5))
def test_numbers_come_back_from_their_residues(values: list[int]) -> None:
    primes = PRIMES[:9]
    inverses = exact.prime_tables().inverses
    for value in values:
        residues = np.array([value % int(p) for p in primes])
        found = mixed_radix_value(residues, primes, inverses, np.empty(9, dtype=np.int64))
        # Nine digits are added, with two roundings each.
        assert abs(Fraction(found) - value) <= 18 * Fraction(2) ** -53 * abs(value)


@pytest.mark.compiled
def test_parabolic_normal_of_a_torus_has_a_sensible_place() -> None:
    """n = ±z touches the torus along whole circles: one point of each sign remains."""
    samples = gm.sample(
        gm.surfaces.torus(), normals=[[0, 0, 1], [0, 0, -1]], cells=(16, 16), on="spline"
    )
    assert sorted(samples.normal_index.tolist()) == [0, 0, 1, 1]
    assert int(samples.elliptic.sum()) == int(samples.hyperbolic.sum()) == 2
    np.testing.assert_allclose(np.abs(samples.points[:, 2]), 0.35, atol=2e-3)
    np.testing.assert_allclose(np.hypot(*samples.points[:, :2].T), 1.0, atol=2e-2)


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["catenoid", "hyperboloid"])
def test_border_vertices_of_a_closed_ring_count_once(name: str) -> None:
    """The first and the last vertex on the border are one place: its normal is asked twice."""
    spline = gm.fit(gm.surfaces.surface(name), (12, 8))
    for v in spline.domain[1]:
        normals = spline.normals(np.linspace(*spline.domain[0], 13), v)
        samples = gm.sample(spline, normals=normals)
        np.testing.assert_array_equal(np.bincount(samples.normal_index, minlength=13), 1)


@pytest.mark.compiled
def test_equal_normals_are_answered_alike() -> None:
    """Those of the vertices on the border, where rounding lets several patches answer."""
    spline = gm.fit(gm.surfaces.elliptic_paraboloid(), (12, 8))
    (u_0, u_1), (v_0, v_1) = spline.domain
    u, v = np.linspace(u_0, u_1, 13), np.linspace(v_0, v_1, 9)
    normals = np.concatenate([spline.normals(u, end) for end in (v_0, v_1)])
    normals = np.concatenate([normals, *(spline.normals(end, v) for end in (u_0, u_1))])
    samples = gm.sample(spline, normals=np.concatenate([normals, normals]))
    counts = np.bincount(samples.normal_index, minlength=2 * len(normals))
    np.testing.assert_array_equal(counts[: len(normals)], 1)
    np.testing.assert_array_equal(counts[len(normals) :], 1)
