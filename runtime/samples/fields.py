"""The fields of samples: their names, columns, shapes and types, and which are wanted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Any
from warnings import catch_warnings, simplefilter

from ..base.errors import InputError, MissingFieldError, shown

if TYPE_CHECKING:  # names of fields stand in the help of commands, which is quick without NumPy
    import numpy as np
    from numpy.typing import DTypeLike, NDArray

__all__ = [
    "ARRAY_NAMES",
    "ARRAY_NAMES_OF_PART",
    "ARRAY_NAMES_ON_SURFACE",
    "COLUMNS",
    "DERIVED",
    "EDGE_NAMES",
    "FLAG_NAMES",
    "FLOAT_NAMES",
    "GRID_NAMES",
    "INDEX_NAMES",
    "INTEGER_NAMES",
    "OPTIONAL_NAMES",
    "PART_NAMES",
    "REAL_NAMES",
    "UNITS",
    "bytes_of",
    "checked_dtype",
    "checked_fields",
    "columns_of",
    "dtype_of",
    "missing_fields",
    "new_field",
    "row_shape",
]

# Every array of `Samples`, and the columns that it has in a table: one for each of its numbers.
COLUMNS: dict[str, tuple[str, ...]] = {
    "points": ("x", "y", "z"),
    "normals": ("nx", "ny", "nz"),
    "uv": ("u", "v"),
    "support": ("support",),
    "gaussian_curvature": ("gaussian_curvature",),
    "mean_curvature": ("mean_curvature",),
    "normal_index": ("normal_index",),
    "patch_index": ("patch_index",),
    "on_surface": ("on_surface",),
    "row": ("row",),
    "column": ("column",),
    "face_index": ("face_index",),
    "solid_index": ("solid_index",),
    "other_normals": ("other_nx", "other_ny", "other_nz"),
    "other_uv": ("other_u", "other_v"),
    "other_face_index": ("other_face_index",),
}
# The units of those that are no integers: L is that of the surface, u and v have their own.
UNITS: dict[str, str] = {
    "points": "L",
    "normals": "1",
    "uv": "parameter",
    "support": "L",
    "gaussian_curvature": "1/L^2",
    "mean_curvature": "1/L",
    "other_normals": "1",
    "other_uv": "parameter",
}
INDEX_NAMES = ("normal_index", "patch_index")
# Only samples of a surface have these, not those of its spline.
FLAG_NAMES = ("on_surface",)
# Only samples of which some are on a grid have these.
GRID_NAMES = ("row", "column")
# Only samples of CAD parts have these.
PART_NAMES = ("face_index", "solid_index")
# Of these, only those of which some are on sharp edges have these.
EDGE_NAMES = ("other_normals", "other_uv", "other_face_index")
OPTIONAL_NAMES = FLAG_NAMES + GRID_NAMES + PART_NAMES + EDGE_NAMES
INTEGER_NAMES = INDEX_NAMES + GRID_NAMES + PART_NAMES + ("other_face_index",)
ARRAY_NAMES: tuple[str, ...] = tuple(name for name in COLUMNS if name not in OPTIONAL_NAMES)
ARRAY_NAMES_ON_SURFACE: tuple[str, ...] = ARRAY_NAMES + FLAG_NAMES
ARRAY_NAMES_OF_PART: tuple[str, ...] = (
    *(name for name in ARRAY_NAMES_ON_SURFACE if name != "patch_index"),
    *PART_NAMES,
)
FLOAT_NAMES: tuple[str, ...] = tuple(name for name in ARRAY_NAMES if name not in INDEX_NAMES)
# All whose numbers may be float32.
REAL_NAMES: tuple[str, ...] = tuple(
    name for name in COLUMNS if name not in INTEGER_NAMES + FLAG_NAMES
)
# What is computed from fields when it is read.
DERIVED: dict[str, tuple[str, ...]] = {
    "elliptic": ("gaussian_curvature",),
    "hyperbolic": ("gaussian_curvature",),
    "parabolic": ("gaussian_curvature",),
    "kind": ("normal_index",),
    "principal_curvatures": ("gaussian_curvature", "mean_curvature"),
}


def row_shape(name: str) -> tuple[int, ...]:
    """Return the shape of what a field holds of one sample."""
    width = len(COLUMNS[name])
    return (width,) if width > 1 else ()


def dtype_of(name: str, floating: DTypeLike) -> np.dtype[Any]:
    """Return the type of a field, if that of all numbers but the indices is `floating`."""
    import numpy as np

    if name in FLAG_NAMES:
        return np.dtype(np.bool_)
    return np.dtype(np.int64 if name in INTEGER_NAMES else floating)


def bytes_of(fields: Iterable[str], floating: DTypeLike) -> int:
    """Return how many bytes the fields of one sample take."""
    return sum(len(COLUMNS[x]) * dtype_of(x, floating).itemsize for x in fields)


def new_field(
    name: str,
    count: int,
    dtype: DTypeLike,
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> NDArray[Any]:
    """Return an array for the field of `count` samples, not yet filled.

    It is a part of that field in `memory`, if this one is large enough and has the type.
    """
    import numpy as np

    held = memory.get(name)
    if held is not None and len(held) >= count and held.dtype == dtype and held.flags.writeable:
        return held[:count]
    return np.empty((count, *row_shape(name)), dtype=dtype)


def columns_of(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the columns of fields, each (N,), as views."""
    return {
        column: part
        for name, array in arrays.items()
        for column, part in zip(COLUMNS[name], array.T if array.ndim > 1 else [array], strict=True)
    }


def checked_fields(
    fields: Sequence[str] | None,
    surface: bool = False,
    grid: bool = False,
    part: bool = False,
    edges: bool = False,
) -> tuple[str, ...]:
    """Return the fields that are wanted, in the order of `COLUMNS`; None stands for all.

    With `surface` they are for samples on the surface, with `grid` for those that may be on a grid,
    with `part` for those of a CAD part, and with `edges` on its sharp edges, too. Raises
    UnknownNameError for an unknown name, InputError for what is no tuple of names, for no names,
    for a name that comes twice, and for one that is computed from fields.
    """
    from ..base.checks import known_name, listed

    known = ARRAY_NAMES_ON_SURFACE if surface else ARRAY_NAMES
    known += GRID_NAMES if grid else ()
    if part:
        known = ARRAY_NAMES_OF_PART + (EDGE_NAMES if edges else ())
    if fields is None:
        return known
    if isinstance(fields, str):
        raise InputError(
            f"fields must be a tuple of names, such as ({shown(fields)},), not a string."
        )
    names = listed(fields)
    if names is None:
        raise InputError(f"fields must be a tuple of names, not {shown(fields)}.")
    if not names:
        raise InputError("fields is empty; name at least one field, such as ('points',).")
    for k, name in enumerate(names):
        if not isinstance(name, str):
            known_name(name, known, "field")
        if name in names[:k]:
            raise InputError(f"fields names {shown(name)} twice; name it once.")
        if name in DERIVED:
            needed = " and ".join(repr(x) for x in DERIVED[name])
            raise InputError(
                f"{name} is computed when it is read, from {needed}; name what it needs."
            )
        if name in FLAG_NAMES and not surface:
            raise InputError(f'{name} is a field of samples on the surface only; see on="surface".')
        if name in PART_NAMES and not part:
            raise InputError(f"{name} is a field of samples of CAD parts only; see gm.read_part.")
        if name in EDGE_NAMES and not edges:
            raise InputError(f"{name} is a field of samples of CAD parts with edges=True only.")
        if name in GRID_NAMES and not grid:
            raise InputError(f'{name} is a field of samples on a grid only; see density="aligned".')
        known_name(name, known, "field")
    return tuple(name for name in known if name in names)


def missing_fields(
    held: Sequence[str], lacking: Sequence[str], subject: str = ""
) -> MissingFieldError:
    """Return the error for samples that hold some fields and lack those that a subject needs."""
    needs = f"{subject} needs {_listed(lacking)}, but " if subject else ""
    return MissingFieldError(
        f"{needs}these samples hold {', '.join(held)} only; "
        f"add {_listed([repr(name) for name in lacking])} to fields=... when sampling."
    )


def _listed(names: Sequence[str]) -> str:
    """Return "a", "a and b" or "a, b and c"."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)


def checked_dtype(dtype: DTypeLike) -> np.dtype[np.floating]:
    """Return float32 or float64, in this machine's byte order; InputError for any other type."""
    import numpy as np

    known = np.dtype(np.float32), np.dtype(np.float64)
    with suppress(Exception), catch_warnings():  # NumPy reads some texts as Python
        simplefilter("ignore")
        if dtype is not None and np.dtype(dtype) in known:
            return known[known.index(np.dtype(dtype))]
    raise InputError(f"dtype must be float32 or float64, not {shown(dtype)}.")
