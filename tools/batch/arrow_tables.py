"""The samples of parts as tables of Arrow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import (
    ARRAY_NAMES,
    ARRAY_NAMES_OF_PART,
    COLUMNS,
    UNITS,
    columns_of,
    dtype_of,
)

if TYPE_CHECKING:  # which bring Numba; reading a data set does without
    from ...runtime.samples.samples import Samples
    from .folder import Settings

__all__ = ["ALWAYS", "points_schema", "points_table"]

# The fields that all samples have if they were asked for, of surfaces and of CAD parts.
ALWAYS = tuple(name for name in ARRAY_NAMES if name in ARRAY_NAMES_OF_PART)


def points_schema(settings: Settings) -> Any:  # noqa: ANN401
    """Return the schema: the number of the part, and a column for each number of a sample.

    Only what some parts have and others have not may be null: the face of a sample, for example.
    """
    arrow = from_extra("pyarrow", "batch", "a data set")
    columns = [
        arrow.field(
            column,
            arrow.from_numpy_dtype(dtype_of(name, settings.dtype)),
            nullable=name not in ALWAYS,
        ).with_metadata({"field": name} | ({"unit": UNITS[name]} if name in UNITS else {}))
        for name in settings.fields
        for column in COLUMNS[name]
    ]
    part = arrow.field("part", arrow.int64(), nullable=False)
    about = {"gaussmap": settings.gaussmap, "formulas": settings.formulas}
    return arrow.schema([part, *columns], metadata=about)


def points_table(samples: Samples, part: int, schema: Any) -> Any:  # noqa: ANN401
    """Return the samples of a part; what they lack is null."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    held = columns_of(samples.arrays())
    count = len(samples)
    arrays = [arrow.array(np.full(count, part, dtype=np.int64))]
    for field in list(schema)[1:]:
        column = held.get(field.name)
        if column is None:
            arrays.append(arrow.nulls(count, field.type))
        else:
            arrays.append(arrow.array(np.ascontiguousarray(column), type=field.type))
    return arrow.table(arrays, schema=schema)
