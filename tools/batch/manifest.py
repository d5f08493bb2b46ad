"""The manifest of a data set: a row for each part, what became of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from ...runtime.base.extras import from_extra

__all__ = [
    "COLUMNS",
    "FAILED",
    "OK",
    "ManifestRow",
    "as_text",
    "manifest_schema",
    "manifest_table",
    "rows_of",
]

OK, FAILED = "ok", "failed"
# The columns: the type of Arrow, whether it may be null, the unit, and what it is.
COLUMNS: dict[str, tuple[str, bool, str, str]] = {
    "part": ("int64", False, "", "the number of the part in the list, from 0 on"),
    "name": ("string", False, "", "the name of the part"),
    "source": ("string", False, "", "the path of the file, or the type of the surface"),
    "content": ("string", False, "", "a SHA-256 of what was sampled, by which it is known again"),
    "status": ("string", False, "", '"ok" or "failed"'),
    "attempts": ("int32", False, "", "how often sampling was tried"),
    "samples": ("int64", False, "", "the number of samples"),
    "misfit": ("float64", True, "L", "the largest distance of the spline from the surface"),
    "coverage": ("float64", True, "L", "the largest distance of the surface from a sample"),
    "angle": ("float64", True, "degree", "the largest angle between normals of surface and sample"),
    "seconds": ("float64", False, "s", "the time that sampling took"),
    "warnings": ("string", False, "", "the warnings, a line for each"),
    "error": ("string", False, "", "why sampling failed, in one sentence"),
}


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """What became of a part; `COLUMNS` says what the numbers are."""

    part: int
    name: str
    source: str
    content: str
    status: str = OK
    attempts: int = 1
    samples: int = 0
    misfit: float | None = None
    coverage: float | None = None
    angle: float | None = None
    seconds: float = 0.0
    warnings: str = ""
    error: str = ""


def manifest_schema() -> Any:  # noqa: ANN401
    """Return the schema of Arrow: types, and in the metadata units and meanings."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    return arrow.schema(
        [
            arrow.field(name, arrow.type_for_alias(kind), nullable=null).with_metadata(
                {"meaning": meaning} | ({"unit": unit} if unit else {})
            )
            for name, (kind, null, unit, meaning) in COLUMNS.items()
        ]
    )


def manifest_table(rows: Iterable[ManifestRow]) -> Any:  # noqa: ANN401
    """Return rows as a table of Arrow."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    # Paths may hold bytes that are no text, which Arrow refuses.
    known = [
        {name: as_text(x) if isinstance(x, str) else x for name, x in asdict(row).items()}
        for row in rows
    ]
    return arrow.Table.from_pylist(known, schema=manifest_schema())


def rows_of(table: Any) -> list[ManifestRow]:  # noqa: ANN401
    """Return the rows that `manifest_table` was given."""
    return [ManifestRow(**row) for row in table.to_pylist()]


def as_text(text: str) -> str:
    """Return a text that can be written: bytes of a path that are no text become escapes."""
    return text.encode("utf-8", "backslashreplace").decode()
