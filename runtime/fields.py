"""The fields of samples: their names, shapes and types, and which of them somebody wants."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from .errors import InputError

if TYPE_CHECKING:  # names of fields stand in the help of commands, which is quick without NumPy
    import numpy as np
    from numpy.typing import DTypeLike, NDArray

__all__ = [
    "ARRAY_NAMES",
    "DERIVED",
    "FLOAT_NAMES",
    "INDEX_NAMES",
    "checked_dtype",
    "checked_fields",
    "new_field",
    "row_shape",
]

# Every array of `Samples`: how many numbers belong to one sample.
_ROWS: dict[str, tuple[int, ...]] = {
    "points": (3,),
    "normals": (3,),
    "uv": (2,),
    "support": (),
    "gaussian_curvature": (),
    "mean_curvature": (),
    "normal_index": (),
    "patch_index": (),
}
ARRAY_NAMES: tuple[str, ...] = tuple(_ROWS)
INDEX_NAMES = ("normal_index", "patch_index")
FLOAT_NAMES: tuple[str, ...] = tuple(name for name in _ROWS if name not in INDEX_NAMES)
# What is computed from fields when it is read.
DERIVED: dict[str, tuple[str, ...]] = {
    "elliptic": ("gaussian_curvature",),
    "hyperbolic": ("gaussian_curvature",),
    "kind": ("normal_index",),
    "principal_curvatures": ("gaussian_curvature", "mean_curvature"),
}


def row_shape(name: str) -> tuple[int, ...]:
    """Return the shape of what a field holds of one sample."""
    return _ROWS[name]


def new_field(name: str, count: int, dtype: DTypeLike) -> NDArray[Any]:
    """Return an array for the field of `count` samples, not yet filled."""
    import numpy as np

    return np.empty((count, *_ROWS[name]), dtype=dtype)


def checked_fields(fields: Sequence[str] | None) -> tuple[str, ...]:
    """Return the fields that are wanted, in the order of `ARRAY_NAMES`; None stands for all.

    Raises InputError for a string, for no names, and for names that are unknown or come twice.
    """
    if fields is None:
        return ARRAY_NAMES
    if isinstance(fields, str):
        raise InputError(f"fields must be a tuple of names, such as ({fields!r},), not a string.")
    try:
        names = list(fields)
    except TypeError:
        raise InputError(f"fields must be a tuple of names, not {fields!r}.") from None
    if not names:
        raise InputError("fields is empty; name at least one field, such as ('points',).")
    for k, name in enumerate(names):
        if name in names[:k]:
            raise InputError(f"fields names {name!r} twice; name it once.")
        if not isinstance(name, str) or name not in _ROWS:
            raise InputError(_unknown(name))
    return tuple(name for name in ARRAY_NAMES if name in names)


def checked_dtype(dtype: DTypeLike) -> np.dtype[np.floating]:
    """Return float32 or float64, in this machine's byte order; InputError for any other type."""
    import numpy as np

    known = np.dtype(np.float32), np.dtype(np.float64)
    with suppress(TypeError, SyntaxError):  # NumPy reads some texts as Python
        if dtype is not None and np.dtype(dtype) in known:
            return known[known.index(np.dtype(dtype))]
    raise InputError(f"dtype must be float32 or float64, not {dtype!r}.")


def _unknown(name: object) -> str:
    if name in DERIVED:
        needed = " and ".join(repr(x) for x in DERIVED[str(name)])
        return f"{name} is computed when it is read, from {needed}; name what it needs."
    near = difflib.get_close_matches(str(name).lower(), ARRAY_NAMES, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there is {', '.join(ARRAY_NAMES)}."
    return f"there is no field {name!r}; {hint}"
