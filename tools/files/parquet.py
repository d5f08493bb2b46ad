"""Parquet files, by Arrow."""

from pathlib import Path
from typing import Any

import numpy as np

from ... import __version__
from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import COLUMNS, columns_of
from ...runtime.samples.samples import Samples
from .content import report_to_json
from .lengths import units_of
from .of_faces import columns_of_faces
from .of_terrain import columns_of_terrain


def write_parquet(samples: Samples, path: Path) -> None:
    """Write a column for each component of a field, and the report in the schema's metadata."""
    table = _table(samples, path)
    # No dictionary encoding: values seldom repeat, and trying it takes half of the time.
    from_extra("pyarrow.parquet", "tables", "a .parquet file").write_table(
        table, path, use_dictionary=False
    )


def _table(samples: Samples, path: Path) -> Any:  # noqa: ANN401
    arrow = from_extra("pyarrow", "tables", f"a {path.suffix} file")
    units, unit = units_of(samples), samples.report.unit
    fields = [
        arrow.field(column, arrow.from_numpy_dtype(array.dtype), nullable=False).with_metadata(
            {"field": name} | ({"unit": units[name]} if name in units else {})
        )
        for name, array in samples.arrays().items()
        for column in COLUMNS[name]
    ]
    columns = [arrow.array(np.ascontiguousarray(x)) for x in columns_of(samples.arrays()).values()]
    for name, array in columns_of_terrain(samples).items():
        fields.append(arrow.field(name, arrow.from_numpy_dtype(array.dtype)))
        columns.append(arrow.array(array))
    kinds = {int: arrow.int64(), float: arrow.float64(), str: arrow.string()}
    for x in columns_of_faces(samples):
        field = arrow.field(x.name, kinds[x.dtype])
        fields.append(field.with_metadata({"unit": x.unit}) if x.unit else field)
        columns.append(arrow.array(x.values, field.type).take(arrow.array(samples.face_index)))
    about = {"gaussmap": __version__, "report": report_to_json(samples.report)}
    about |= {} if unit is None else {"unit_of_length": unit}
    return arrow.table(columns, schema=arrow.schema(fields, metadata=about))
