"""The manifest of a data set: a row for each part, with its status and results."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from ...runtime.base.extras import from_extra

OK, FAILED = "ok", "failed"
# The name of the Arrow type for each Python type of a column.
TYPES = {"int": "int64", "str": "string", "float | None": "float64"}


def _column(meaning: str, unit: str = "", **default: Any) -> Any:  # noqa: ANN401
    """Return the dataclass field of a column, with the meaning and the unit as metadata."""
    about = {"meaning": meaning} | ({"unit": unit} if unit else {})
    return field(metadata=about, **default)


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """A row of the manifest: the status and results of a part.

    They do not depend on when, or how often, the part was sampled.
    """

    part: int = _column("the number of the part in the list, from 0 on")
    name: str = _column("the name of the part")
    source: str = _column("the path of the file, or the type of the surface")
    content: str = _column("a SHA-256 of what was sampled, by which it is known again", default="")
    status: str = _column('"ok" or "failed"', default=OK)
    parameters: str = _column(
        "those of a surface of the catalogue, as JSON; empty for others", default=""
    )
    samples: int = _column("the number of samples", default=0)
    unit_of_length: str = _column('L: the unit of lengths, as "mm"; empty if unknown', default="")
    misfit: float | None = _column(
        "the largest distance of the spline from the surface", "L", default=None
    )
    coverage: float | None = _column(
        "the largest distance of the surface from a sample", "L", default=None
    )
    angle: float | None = _column(
        "the largest angle between normals of surface and sample", "degree", default=None
    )
    warnings: str = _column("the warnings, a line for each", default="")
    error: str = _column("why sampling failed, in one sentence", default="")


COLUMNS = {x.name: x for x in fields(ManifestRow)}


def manifest_schema() -> Any:  # noqa: ANN401
    """Return the Arrow schema of the manifest, with units and meanings of columns as metadata."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    return arrow.schema(
        [
            arrow.field(
                name, arrow.type_for_alias(TYPES[str(x.type)]), nullable="None" in str(x.type)
            ).with_metadata(dict(x.metadata))
            for name, x in COLUMNS.items()
        ]
    )


def manifest_table(rows: Iterable[ManifestRow]) -> Any:  # noqa: ANN401
    """Return rows of the manifest as an Arrow table."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    # Paths may hold bytes that are not valid UTF-8, which Arrow refuses.
    known = [
        {name: as_text(x) if isinstance(x, str) else x for name, x in asdict(row).items()}
        for row in rows
    ]
    return arrow.Table.from_pylist(known, schema=manifest_schema())


def as_text(text: str) -> str:
    """Return an encodable text: bytes of a path that are not valid UTF-8 become escapes."""
    return text.encode("utf-8", "backslashreplace").decode()
