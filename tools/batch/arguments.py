"""The checked arguments of a data set: what is asked, how it is stored, and where it is sampled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import DTypeLike

from ...runtime.base.checks import (
    known_name,
    listed,
    pair_of_cells,
    positive_number,
    whole_number,
)
from ...runtime.base.memory import GIB
from ...runtime.base.memory import memory_limit as most_memory
from ...runtime.base.threads import thread_count
from ...runtime.place.on_surface import checked_place
from ...runtime.samples.fields import FLOAT_NAMES, PART_NAMES, checked_dtype, checked_fields
from ...runtime.samples.request import Request
from ..files.formats import SUFFIXES
from ..sources.named import Named
from .asked import Asked
from .child import Limits
from .folder import CODECS

__all__ = ["CODEC", "SECONDS", "Where", "asked_of", "stored", "where"]

CODEC, SECONDS = "zstd", 600.0
# The part of this machine's memory that all workers may use.
SHARE = 0.9


@dataclass(frozen=True, slots=True)
class Where:
    """Where parts are sampled: so many processes here, or Dask's client or scheduler."""

    workers: int
    limits: Limits
    scheduler: Any = None


def asked_of(
    request: Request,
    cells: Sequence[int] | None,
    on: str | None,
    measured: bool,
    named: Named | None = None,
) -> Asked:
    """Return what is asked of each part; `named` has the options with which files are read."""
    arguments = {
        "count": request.count,
        "angle": request.angle,
        "coverage": request.coverage,
        "density": request.density,
        "relax": request.relax,
        "cells": None if cells is None else list(pair_of_cells(cells)),
        "on": checked_place(on),
    }
    return Asked(arguments, request.normals, named or Named(), measured)


def stored(
    fields: Sequence[str] | None, dtype: DTypeLike, compression: str, files: str | None
) -> dict[str, Any]:
    """Return the entries of `Settings` that say how samples are stored."""
    if files is not None:
        known_name(files, SUFFIXES, "suffix of files")
    return {
        "fields": FLOAT_NAMES if fields is None else _known_fields(fields),
        "dtype": checked_dtype(dtype).name,
        "compression": known_name(compression, CODECS, "compression"),
        "files": files,
    }


def _known_fields(fields: Sequence[str]) -> tuple[str, ...]:
    """Return fields of which some parts may have none: those of CAD parts, and of grids."""
    names = listed(fields)
    if names is None:
        return checked_fields(fields)  # which raises
    others = [name for name in names if not isinstance(name, str) or name not in PART_NAMES]
    wanted = checked_fields(others, True, grid=True)
    return wanted + tuple(name for name in PART_NAMES if name in names)


def where(
    workers: int | None, scheduler: object, time_limit: float, memory_limit: float | None
) -> Where:
    """Return where parts are sampled, and within which limits."""
    count = thread_count(None) if workers is None else whole_number(workers, "workers")
    memory = SHARE * most_memory() / GIB / count if memory_limit is None else memory_limit
    limits = Limits(
        positive_number(time_limit, "time_limit", "seconds"),
        positive_number(memory, "memory_limit", "GiB"),
    )
    return Where(count, limits, scheduler)
