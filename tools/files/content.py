"""The metadata of samples in files: the report, and the names of the fields."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict

from ...runtime.samples.fields import COLUMNS
from ...runtime.samples.report import SamplingReport
from .reading import UnusableError


def report_to_json(report: SamplingReport) -> str:
    """Return a report as one line of ASCII."""
    return json.dumps(asdict(report))


def report_from_json(text: str) -> SamplingReport:
    """Return the report from the text of `report_to_json`."""
    return SamplingReport(**json.loads(text))


def known_fields(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the fields in a file, in the order of `COLUMNS`.

    Raises UnusableError if there are no fields, or unknown ones.
    """
    held = set(names)
    if not held or not held <= set(COLUMNS):
        raise UnusableError("holds fields that gaussmap does not know; update gaussmap.")
    return tuple(name for name in COLUMNS if name in held)


def lacks(what: str, missing: Sequence[str]) -> UnusableError:
    """Return the error for a file that lacks some arrays or columns."""
    return UnusableError(f"lacks the {what} {', '.join(missing)}; read a file that gaussmap wrote.")
