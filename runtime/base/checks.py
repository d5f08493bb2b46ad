"""Checks of arguments: whole numbers, real numbers, arrays, and names ("did you mean")."""

import difflib
import math
from collections.abc import Sequence
from contextlib import suppress
from itertools import islice
from typing import Any, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .errors import InputError, UnknownNameError, shown
from .limits import MOST
from .memory import check_memory

# Tuples of types for `isinstance`, made once, since a report checks many numbers.
WHOLE, OF_NUMPY = (int, np.integer), (np.ndarray, np.generic)
SIMILAR = 0.7  # similarity of a name to the intended one, see difflib
# The largest number of entries of a list or tuple: MOST_LISTED if the entries are checked one by
# one, MOST_CONVERTED if the sequence is converted to an array. The entries of nested sequences are
# counted down to the depth DEEPEST.
MOST_LISTED, MOST_CONVERTED, DEEPEST = 10**7, 10**8, 4


def known_name(name: str, known: Sequence[str], kind: str, command: str = "") -> str:
    """Return `name` if it is known; otherwise UnknownNameError lists similar or all names.

    If the names are too many for a message, `command` is the shell command that lists them.
    """
    text = name if isinstance(name, str) else ""
    if text and text in known:
        return text
    near = _near(text.lower(), known)
    hint = f"; did you mean {' or '.join(near)}?" if near else "."
    if command:
        hint += f" See `{command}` for all names."
    elif not near:
        hint = f"; there is {', '.join(known)}." if known else "; there is none."
    raise UnknownNameError(f"there is no {kind} {shown(name)}{hint}")


def _near(text: str, known: Sequence[str]) -> list[str]:
    """Return up to three names that are similar to a text, or else contain a similar word."""
    near = difflib.get_close_matches(text, known, n=3, cutoff=SIMILAR)
    words = {word for name in known for word in name.split("_")} if not near else ()
    best = difflib.get_close_matches(text, words, n=1, cutoff=SIMILAR)
    return near or [name for name in known if best and best[0] in name.split("_")][:3]


def whole_number(value: object, name: str, least: int = 1, most: int = MOST) -> int:
    """Return a whole number from `least` to `most`; otherwise InputError, with its `name`."""
    if isinstance(value, bool) or not isinstance(value, WHOLE) or value < least:
        example = ""
        if isinstance(value, float | np.floating) and least <= value <= most:
            example = f"; {round(value)} for example"
        raise InputError(
            f"{name} must be a whole number of at least {least}, not {shown(value)}{example}."
        )
    if value > most:
        raise InputError(f"{name} must be a whole number of at most {most:,}, not {shown(value)}.")
    return int(value)


def pair_of_cells(cells: Sequence[int]) -> tuple[int, int]:
    """Return the numbers of cells (m, n); InputError unless both are positive whole numbers."""
    try:
        m, n = cells
    except Exception:  # conversion may raise anything
        raise InputError(
            f"cells must be a pair of whole numbers (m, n), not {shown(cells)}."
        ) from None
    return whole_number(m, "cells[0]"), whole_number(n, "cells[1]")


def checked_count(value: object) -> int:
    """Return a number of samples; InputError for other values, with a hint if they are arrays."""
    shape = getattr(value, "shape", None)
    if isinstance(value, list | tuple) or (isinstance(shape, tuple) and shape):
        raise InputError(
            f"count must be a whole number of at least 1, not {shown(value)}; normals go by "
            "keyword: normals=…"
        )
    return whole_number(value, "count")


def as_float(value: SupportsFloat | str) -> float:
    """Return float(value); TypeError if that fails, and for complex or masked numbers of NumPy."""
    if isinstance(value, OF_NUMPY) and (value.dtype.kind == "c" or np.ma.is_masked(value)):
        raise TypeError("neither complex nor masked arrays are real numbers")
    try:
        return float(value)
    except Exception as error:  # conversion may raise anything
        raise TypeError(str(error)) from error


def listed(values: object) -> list[Any] | None:
    """Return the elements of an iterable object as a list; None for texts, dicts, other objects.

    None is also returned for more than MOST_LISTED elements, those of nested sequences included. An
    empty sequence gives [].
    """
    if isinstance(values, str | bytes | dict) or _size(values) > MOST_LISTED:
        return None
    try:
        found = list(islice(values, MOST_LISTED + 1))  # pyright: ignore[reportArgumentType]
    except Exception:  # arrays without dimension raise TypeError; objects may raise anything
        return None
    return found if len(found) <= MOST_LISTED else None


def _size(values: object) -> int:
    """Return the number of entries of a sequence or array, including those of nested sequences.

    Nested sequences are assumed to be as long as the first of them. The number is 1 for any other
    object. Nothing is converted: a view of an array, or a `range`, may have more entries than fit
    into memory.
    """
    size, depth = 1, 0
    while isinstance(values, list | tuple | range | np.ndarray) and depth < DEEPEST:
        if isinstance(values, np.ndarray):
            return size * values.size
        if not values:
            return 0
        # `len` fails for a range that is longer than the largest index.
        step = values.step if isinstance(values, range) else 0
        length = (values[-1] - values[0]) // step + 1 if step else len(values)
        size, values, depth = size * length, values[0], depth + 1
    return size


def _check_size(values: object, name: str) -> None:
    """Raise InputError for a sequence of Python with too many entries to become an array."""
    if not isinstance(values, np.ndarray) and (size := _size(values)) > MOST_CONVERTED:
        raise InputError(
            f"{name} has {size:,} entries, too many for a sequence of Python; give a NumPy array."
        )


def text(value: object, name: str) -> str:
    """Return a str, also from NumPy's str_; InputError, with `name`, for any other value."""
    if not isinstance(value, str):
        raise InputError(f"{name} must be a text, not {shown(value)}.")
    return str(value)


def yes_or_no(value: object, name: str) -> bool:
    """Return the truth value of a value.

    Raises InputError, with `name`, if the value has none; an array of several entries has none.
    """
    try:
        return bool(value)
    except Exception:
        raise InputError(f"{name} must be True or False, not {shown(value)}.") from None


def finite_number(value: SupportsFloat, name: str) -> float:
    """Return a finite number as a float; InputError, with `name`, for any other value."""
    try:
        number = math.nan if isinstance(value, str) else as_float(value)
    except TypeError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{name} must be a finite number, not {shown(value)}.")
    return number


def positive_number(
    value: object, name: str, unit: str = "", most: float = math.inf, *, infinite: bool = False
) -> float:
    """Return a positive number up to `most`; InputError, with `name`, for any other value.

    Infinity is refused unless `infinite` is true.
    """
    number = math.nan
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        with suppress(OverflowError):  # from whole numbers beyond float64
            number = float(value)
    if not 0.0 < number <= most or (math.isinf(number) and not infinite):
        limit = "" if math.isinf(most) else f" of at most {most:g}{unit}"
        raise InputError(f"{name} must be a positive number{limit}, not {shown(value)}.")
    return number


def finite_array(
    values: ArrayLike, shape: tuple[int | str, ...] | None, name: str
) -> NDArray[np.float64]:
    """Return values as a float64 array of finite numbers; otherwise InputError, with `name`.

    The array must have the given shape, unless it is None; a letter in the shape stands for any
    number.
    """
    found = real_values(values, name)
    if shape is not None and not _fits(found, shape):
        raise InputError(f"{name} must have the shape {_shown(shape)}, not {found.shape}.")
    array = _copy(found)
    if not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0].tolist()
        value = float(array[tuple(where)])
        raise InputError(f"{name} holds NaN or infinity: {value} at index {where}.")
    return array


def real_array(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a C-contiguous float64 copy of an array of real numbers; InputError otherwise.

    Text, complex numbers, objects and masked entries are not real numbers.
    """
    return _copy(real_values(values, name))


def _copy(array: NDArray[Any]) -> NDArray[np.float64]:
    """Return a C-contiguous float64 copy; InputError if there is not enough memory for it."""
    check_memory("numbers", array.size)
    with np.errstate(over="ignore"):
        return array.astype(np.float64, order="C")


def with_gaps(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the array of `real_array`, with NaN in place of masked entries."""
    if not isinstance(values, np.ma.MaskedArray):
        return real_array(values, name)
    array = real_array(values.data, name)
    array[np.ma.getmaskarray(values)] = np.nan
    return array


def real_values(values: ArrayLike, name: str) -> NDArray[Any]:
    """Return real numbers as an array, without a copy where possible; see `real_array`."""
    if np.ma.is_masked(values):
        raise InputError(f"{name} has masked entries; fill them or leave them out.")
    _check_size(values, name)
    try:
        array = np.asarray(values)
    except Exception:  # objects raise anything: tensors that require gradients RuntimeError
        raise InputError(f"{name} must be an array of real numbers, with equal rows.") from None
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} must be an array of real numbers, not of type {array.dtype}.")
    return array


def parameter_arrays(u: ArrayLike, v: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return u and v, broadcast to one shape; InputError if they do not, or are not real."""
    u_array, v_array = real_array(u, "u"), real_array(v, "v")
    try:
        shape = np.broadcast_shapes(u_array.shape, v_array.shape)
    except ValueError:
        raise InputError(
            f"u and v do not broadcast together: their shapes are {u_array.shape} and "
            f"{v_array.shape}."
        ) from None
    return np.broadcast_to(u_array, shape), np.broadcast_to(v_array, shape)


def checked_array(
    name: str, array: object, shape: tuple[int | str, ...], dtype: DTypeLike
) -> NDArray[Any]:
    """Return a C-contiguous array; InputError unless it has the given shape and type.

    A letter in the shape stands for any number.
    """
    if not isinstance(array, np.ndarray):
        raise InputError(f"{name} must be a NumPy array, not {type(array).__name__}.")
    if array.dtype != dtype or not (array.shape == shape or _fits(array, shape)):
        raise InputError(
            f"{name} must be a {np.dtype(dtype)} array of shape {_shown(shape)}, "
            f"not a {array.dtype} array of shape {array.shape}."
        )
    if not array.flags.c_contiguous:
        check_memory("numbers", array.size)
    return np.ascontiguousarray(array)


def _fits(array: NDArray[Any], shape: tuple[int | str, ...]) -> bool:
    if len(shape) != array.ndim:
        return False
    for wanted, found in zip(shape, array.shape, strict=True):  # no generator: called very often
        if wanted != found and not isinstance(wanted, str):
            return False
    return True


def _shown(shape: tuple[int | str, ...]) -> str:
    return str(shape).replace("'", "")


def checked_rows(key: ArrayLike, count: int) -> NDArray[Any]:
    """Return a mask (count,) or valid indices (M,) of samples; InputError for anything else.

    A single number counts as an array of length 1.
    """
    _check_size(key, "the key of samples")
    try:
        rows = np.asarray(key)
    except Exception:  # ragged lists, and objects that raise anything
        rows = np.empty(())
    if rows.ndim == 0 and rows.dtype.kind in "iu":
        rows = rows[None]
    if rows.shape == (0,) and rows.dtype.kind == "f":
        rows = rows.astype(np.intp)  # NumPy makes an empty list an array of floats
    if rows.ndim != 1 or rows.dtype.kind not in "biu":
        raise InputError(
            "samples are picked by a number, a slice, a boolean mask or a 1-D index array."
        )
    if rows.dtype.kind == "b" and len(rows) != count:
        raise InputError(f"the mask has {len(rows)} entries, but there are {count} samples.")
    if rows.dtype.kind != "b" and len(rows) and not -count <= rows.min() <= rows.max() < count:
        raise InputError(f"an index is out of range: there are {count} samples.")
    return rows
