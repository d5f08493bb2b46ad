"""The fields of samples: their names, columns, shapes, types, and the selection of fields."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from enum import IntEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple
from warnings import catch_warnings, simplefilter

from ..base.errors import InputError, MissingFieldError, shown

if TYPE_CHECKING:  # the help of commands lists the names of fields, and is quick without NumPy
    import numpy as np
    from numpy.typing import DTypeLike, NDArray


class Component(IntEnum):
    """The components of the points that have a prescribed normal; each has one sample.

    Attributes
    ----------
    REGULAR
        A point with K ≠ 0: the only one with this normal nearby.
    ISOLATED
        A point with K = 0 that is the only one with this normal nearby, or several that cannot be
        told apart.
    CURVE
        A curve or a region of points with the same normal; the sample is one of these points. Each
        piece inside a trim has a sample, if the pieces and the gaps between them are longer than
        1/256 of a line u = const or v = const, or than 1/64 of any other curve or region.
    TIP
        A tip of the surface, such as that of a cone, whose normal cone contains the normal.
    CREASE
        A point of a crease, where the normal is between those of both sides, or a corner where two
        creases cross, whose normal cone contains the normal. Splines end at creases: with
        ``on="spline"`` there are no such samples.

    Examples
    --------
    >>> import gaussmap as gm
    >>> kinds = gm.Component
    >>> samples = gm.GaussMap("torus").points([[1, 0, 0]])
    >>> samples.component.tolist() == [kinds.REGULAR] * 2
    True
    >>> [int(x) for x in (kinds.ISOLATED, kinds.CURVE, kinds.TIP, kinds.CREASE)]
    [1, 2, 3, 4]

    """

    REGULAR = 0
    ISOLATED = 1
    CURVE = 2
    TIP = 3
    CREASE = 4


class Field(NamedTuple):
    """An array of `Samples`: the names of its columns in a table, and the kind of its entries.

    `only` is the group of samples that have the array, a key of ONLY; "" if all samples have it.
    `unit` is the unit of real numbers: L for lengths of the surface, "parameter" for u and v, which
    may have different units.
    """

    columns: tuple[str, ...]
    unit: str = ""
    kind: str = "real"
    only: str = ""


FIELDS: dict[str, Field] = {
    "points": Field(("x", "y", "z"), "L"),
    "normals": Field(("nx", "ny", "nz"), "1"),
    "uv": Field(("u", "v"), "parameter"),
    "support": Field(("support",), "L"),
    "gaussian_curvature": Field(("gaussian_curvature",), "1/L^2"),
    "mean_curvature": Field(("mean_curvature",), "1/L"),
    "normal_index": Field(("normal_index",), kind="index"),
    "patch_index": Field(("patch_index",), kind="index"),
    "on_surface": Field(("on_surface",), kind="flag", only="surface"),
    "uv_radius": Field(("u_radius", "v_radius"), "parameter", only="proved"),
    "component": Field(("component",), kind="code", only="given"),
    "row": Field(("row",), kind="index", only="grid"),
    "column": Field(("column",), kind="index", only="grid"),
    "face_index": Field(("face_index",), kind="index", only="part"),
    "solid_index": Field(("solid_index",), kind="index", only="part"),
    "other_normals": Field(("other_nx", "other_ny", "other_nz"), "1", only="edges"),
    "other_uv": Field(("other_u", "other_v"), "parameter", only="edges"),
    "other_face_index": Field(("other_face_index",), kind="index", only="edges"),
}
# Groups of samples with fields that other samples lack, and how messages describe each group.
ONLY = {
    "surface": "on the surface only, not on its spline",
    "proved": "at prescribed normals of surfaces with bounds of their derivatives only",
    "given": "at prescribed normals only",
    "grid": 'on a grid only, of density "aligned"',
    "part": "of CAD parts only",
    "edges": "of CAD parts with samples on edges only",
}


def _only(samples: str) -> tuple[str, ...]:
    return tuple(name for name, x in FIELDS.items() if x.only == samples)


def _of_kind(kind: str) -> tuple[str, ...]:
    return tuple(name for name, x in FIELDS.items() if x.kind == kind)


COLUMNS = {name: x.columns for name, x in FIELDS.items()}
UNITS = {name: x.unit for name, x in FIELDS.items() if x.unit}
ARRAY_NAMES, FLAG_NAMES, PROVED_NAMES, GIVEN_NAMES, GRID_NAMES, PART_NAMES, EDGE_NAMES = map(
    _only, ("", *ONLY)
)
REAL_NAMES, INTEGER_NAMES = _of_kind("real"), _of_kind("index")
FLOAT_NAMES = tuple(name for name in ARRAY_NAMES if name in REAL_NAMES)
INDEX_NAMES = tuple(name for name in ARRAY_NAMES if name in INTEGER_NAMES)
ARRAY_NAMES_ON_SURFACE = ARRAY_NAMES + FLAG_NAMES
ARRAY_NAMES_OF_PART = tuple(x for x in ARRAY_NAMES_ON_SURFACE if x != "patch_index") + PART_NAMES
# Attributes that are computed from fields when they are read.
DERIVED: dict[str, tuple[str, ...]] = {
    "elliptic": ("gaussian_curvature",),
    "hyperbolic": ("gaussian_curvature",),
    "parabolic": ("gaussian_curvature",),
    "kind": ("normal_index",),
    "principal_curvatures": ("gaussian_curvature", "mean_curvature"),
    "slope": ("normals",),
    "aspect": ("normals",),
}


def row_shape(name: str) -> tuple[int, ...]:
    """Return the shape of a field for one sample."""
    width = len(COLUMNS[name])
    return (width,) if width > 1 else ()


def dtype_of(name: str, floating: DTypeLike) -> np.dtype[Any]:
    """Return the dtype of a field, `floating` for all fields of real numbers."""
    import numpy as np

    types = {"index": np.int64, "flag": np.bool_, "code": np.uint8}
    return np.dtype(types.get(FIELDS[name].kind, floating))


def bytes_of(fields: Iterable[str], floating: DTypeLike) -> int:
    """Return the number of bytes of the fields of one sample."""
    import numpy as np

    sizes = {"flag": 1, "code": 1, "index": 8, "real": np.dtype(floating).itemsize}
    return sum(len(COLUMNS[x]) * sizes[FIELDS[x].kind] for x in fields)


def new_field(
    name: str,
    count: int,
    dtype: DTypeLike,
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> NDArray[Any]:
    """Return an uninitialized array for a field of `count` samples.

    The array is a part of `memory[name]`, if that array is large enough and has the same dtype.
    """
    import numpy as np

    held = memory.get(name)
    if held is not None and len(held) >= count and held.dtype == dtype and held.flags.writeable:
        return held[:count]
    return np.empty((count, *row_shape(name)), dtype=dtype)


def regular(
    count: int, fields: Sequence[str], memory: Mapping[str, NDArray[Any]] = MappingProxyType({})
) -> dict[str, NDArray[Any]]:
    """Return {"component": codes of `count` regular points}; {} without "component" in `fields`."""
    found = {x: new_field(x, count, dtype_of(x, "f8"), memory) for x in GIVEN_NAMES if x in fields}
    for array in found.values():
        array[:] = Component.REGULAR
    return found


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
    proved: bool | None = False,
    grid: bool = False,
    part: bool = False,
    edges: bool = False,
    given: bool = False,
) -> tuple[str, ...]:
    """Return the requested fields, in the order of `COLUMNS`; None means all.

    The flags describe the samples: on the surface (`surface`), at prescribed normals (`given`), of
    a proved search (`proved`; None if unknown), on a grid (`grid`), of a CAD part (`part`), on its
    sharp edges (`edges`). Raises UnknownNameError for an unknown name. Raises InputError for
    anything but several names, for no names, for a repeated name, for a field that such samples
    lack, and for an attribute that is computed from fields.
    """
    from ..base.checks import known_name, listed

    has = {
        "": True, "surface": surface, "proved": proved is not False,
        "given": given or proved is not False, "grid": grid,
        "part": part, "edges": edges,
    }  # fmt: skip
    without = ("patch_index",) if part or proved else ()
    known = tuple(x for x in FIELDS if has[FIELDS[x].only] and x not in without)
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
        if name in FIELDS and not has[FIELDS[name].only]:
            raise InputError(f"{name} is a field of samples {ONLY[FIELDS[name].only]}.")
        if name in without:
            raise InputError(f"{name} is a field of samples on a spline only.")
        known_name(name, known, "field")
    return tuple(name for name in known if name in names)


def missing_fields(
    held: Sequence[str], lacking: Sequence[str], subject: str = ""
) -> MissingFieldError:
    """Return the error for samples that have the fields `held`, but not `lacking`."""
    needs = f"{subject} needs {_listed(lacking)}, but " if subject else ""
    return MissingFieldError(
        f"{needs}these samples hold {', '.join(held)} only; "
        f"add {_listed([repr(name) for name in lacking])} to the fields when sampling."
    )


def _listed(names: Sequence[str]) -> str:
    """Return "a", "a and b" or "a, b and c"."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)


def checked_dtype(dtype: DTypeLike) -> np.dtype[np.floating]:
    """Return float32 or float64, in this machine's byte order; InputError for any other type."""
    import numpy as np

    known = np.dtype(np.float32), np.dtype(np.float64)
    for number in known:
        if dtype is number or dtype is number.type:
            return number
    with suppress(Exception), catch_warnings():  # NumPy evaluates some texts as Python
        simplefilter("ignore")
        if dtype is not None and np.dtype(dtype) in known:
            return known[known.index(np.dtype(dtype))]
    raise InputError(f"dtype must be float32 or float64, not {shown(dtype)}.")


def count_of(arrays: Mapping[str, NDArray[Any]]) -> int:
    """Return the number of samples, given the arrays of their fields."""
    return len(next(iter(arrays.values())))
