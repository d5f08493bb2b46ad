"""Columns of tables that describe the face of a part on which a sample lies."""

import csv
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from ...runtime.samples.whole import FaceColumn
from .lengths import whole_of

# Spreadsheets interpret texts with these beginnings as formulas, unless an apostrophe comes first.
FORMULA = ("=", "+", "-", "@", "\t", "\r")


def columns_of_faces(samples: Samples) -> list[FaceColumn]:
    """Return the columns with their units.

    There are none unless the samples have a part and indices of faces.
    """
    part = whole_of(samples)
    if part is None or samples.face_index is None:
        return []
    return [x._replace(unit=x.unit.replace("L", part.unit)) for x in part._face_columns()]


def texts_of(column: FaceColumn, samples: Samples) -> NDArray[Any]:
    """Return the texts of a column in a .csv file, one for each sample (N,)."""
    return np.array([_text(x) for x in column.values], dtype=object)[samples.face_index]


def _text(value: float | str | None) -> str:
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, str) and value.startswith(FORMULA):
        value = f"'{value}"
    line = io.StringIO()
    # The writer quotes a name that contains \r or \n only if this character is in the line
    # terminator.
    csv.writer(line, lineterminator="\r\n").writerow(["" if value is None else value, ""])
    return line.getvalue()[:-3]
