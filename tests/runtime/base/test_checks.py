"""Checks of arguments, and values in messages of errors."""

from decimal import Decimal
from fractions import Fraction

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.base import errors
from gaussmap.runtime.base.checks import parameter_arrays, real_array, whole_number

from ...refusals import refused


@pytest.mark.parametrize("value", [1, 7, np.int8(7), np.uint64(7), 10**9])
def test_whole_numbers(value):
    result = whole_number(value, "count")
    assert result == value
    assert type(result) is int


@pytest.mark.parametrize("value", [10**9 + 1, 10**30, 10**400])
def test_whole_numbers_beyond_all_memory(value):
    refused(r"^count must be a whole number of at most 1,000,000,000", whole_number, value, "count")


@pytest.mark.parametrize(
    "value",
    [0, -1, True, False, np.True_, 1.0, 1.5, np.float32(3), float("nan"), float("inf"), "5", None,
     [5], np.array(5), 1j, Fraction(4, 2)], ids=repr,
)  # fmt: skip
def test_what_is_not_a_whole_number(value):
    refused(r"^count must be a whole number of at least 1, not .*\.$", whole_number, value, "count")


def test_real_arrays_come_as_copies_in_c_order():
    source = np.asfortranarray(np.arange(12.0).reshape(3, 4))
    source.setflags(write=False)
    result = real_array(source, "a grid")
    assert result.flags.c_contiguous
    assert result.flags.writeable
    assert not np.shares_memory(result, source)
    np.testing.assert_array_equal(result, source)


@pytest.mark.parametrize(
    "values",
    [[[1, 2], [3, 4]], ((1.0, 2.0), (3.0, 4.0)), np.array([[1, 2], [3, 4]], np.int16),
     np.array([[1, 2], [3, 4]], np.float16), np.array([[1, 2], [3, 4]], ">f8"),
     np.array([[1, 2], [3, 4]], np.longdouble), np.array([[1, 0, 2], [3, 0, 4]])[:, ::2],
     np.ma.masked_array([[1, 2], [3, 4]], mask=False)],
)  # fmt: skip
def test_what_counts_as_an_array_of_real_numbers(values):
    result = real_array(values, "a grid")
    assert result.dtype == np.float64
    assert type(result) is np.ndarray
    assert result.tolist() == [[1.0, 2.0], [3.0, 4.0]]


def test_booleans_and_single_numbers_are_real():
    assert real_array([True, False], "a grid").tolist() == [1.0, 0.0]
    assert real_array(3, "u").shape == ()


def test_too_large_for_float64_is_infinite_without_a_warning():
    huge = np.longdouble("1e400")
    if not np.isfinite(huge):
        pytest.skip("long double is no longer than double here")
    assert real_array([huge], "u").tolist() == [np.inf]


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        (np.ones(3, complex), "not of type complex128"),  # even if the imaginary part is zero
        (["1", "2"], "not of type <U1"),
        (b"12", "not of type .S2"),
        ([Decimal(1)], "not of type object"),
        (None, "not of type object"),
        (iter([1.0]), "not of type object"),
        (np.zeros(2, "M8[s]"), "not of type datetime64"),
        ([[1.0, 2.0], [3.0]], "with equal rows"),
        (np.ma.masked_array([1.0, 2.0], mask=[True, False]), "masked entries"),
    ],
)
def test_what_is_not_an_array_of_real_numbers(values, complaint):
    refused(rf"^a grid [^\n]*{complaint}[^\n]*\.$", real_array, values, "a grid")


def test_parameters_broadcast_together():
    u, v = parameter_arrays([[1], [2]], [3, 4, 5])
    assert u.tolist() == [[1, 1, 1], [2, 2, 2]]
    assert v.tolist() == [[3, 4, 5], [3, 4, 5]]
    u, v = parameter_arrays(1, 2)
    assert u.shape == v.shape == ()


def test_parameters_that_do_not_fit_together():
    refused(r"shapes are \(3,\) and \(2,\)", parameter_arrays, [1, 2, 3], [1, 2])
    refused(r"^u must be", parameter_arrays, "a", 1)
    refused(r"^v must be", parameter_arrays, 1, 1j)


# --- values in messages of errors -----------------------------------------------------------------


class Unprintable:
    """An object whose repr raises."""

    def __repr__(self) -> str:
        raise OSError("no")


def test_values_are_shown_on_one_short_line() -> None:
    assert errors.shown("a") == "'a'"
    assert errors.shown(np.eye(2)) == "array([[1., 0.], [0., 1.]])"
    assert errors.shown(10**5000) == "something of type int"
    assert errors.shown(Unprintable()) == "something of type Unprintable"
    assert len(errors.shown("x" * 1000)) == 60
    assert errors.shown("\ud800").encode() == rb"'\ud800'"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a\nb\tc\x1b[31m\x7f", r"a\nb\tc\x1b[31m\x7f"),
        ("\udc80\u2028\u202e", r"\udc80\u2028\u202e"),
        ("Zürich √2 (1\u00a0m)", "Zürich √2 (1\u00a0m)"),
    ],
)
def test_messages_have_one_line_without_control_characters(text: str, said: str) -> None:
    """Paths do not change a terminal."""

    assert errors.clipped(text) == said
    assert str(gm.errors.FileError(text)) == str(gm.GaussmapWarning(text)) == said
    with pytest.raises(gm.GaussmapError) as caught:
        gm.read_samples(f"nowhere/{text}.ply")
    assert said in str(caught.value)
