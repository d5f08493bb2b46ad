"""What a run does: what is asked of each part, how it is stored, and within which limits."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.checks import (
    known_name,
    listed,
    pair_of_cells,
    positive_number,
)
from ...runtime.base.memory import GIB
from ...runtime.base.memory import memory_limit as most_memory
from ...runtime.place.on_surface import checked_place
from ...runtime.samples.fields import FLOAT_NAMES, PART_NAMES, checked_dtype, checked_fields
from ...runtime.samples.request import Request
from ..files.formats import SUFFIXES
from ..files.paths import atomic_path
from ..sources.named import Named
from .folder import CODECS, FILES, NORMALS, Settings
from .inputs import Input
from .manifest import ManifestRow

__all__ = [
    "CODEC",
    "SECONDS",
    "Asked",
    "Limits",
    "Plan",
    "asked_of",
    "file_name",
    "limits_of",
    "normals_in",
    "stored",
]

CODEC, SECONDS = "zstd", 600.0
# The part of this machine's memory that all workers may use.
SHARE = 0.9
LONGEST_NAME = 60  # of a part, in the name of its file


@dataclass(frozen=True, slots=True)
class Limits:
    """The longest time that a part may take, in seconds, and the most memory, in GiB."""

    seconds: float
    memory: float


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """The arguments of `sample` for all parts, but for fields and types.

    Attributes
    ----------
    arguments : dict
        Numbers and names: count, angle, coverage, density, reach, cells, on.
    normals : (S, 3) float64 array, str or None
        Directions, or the file that holds them.
    named : Named
        The options with which files become surfaces.
    measured : bool
        Whether coverage and normal deviation are measured where they were not asked for.

    """

    arguments: dict[str, Any]
    normals: NDArray[np.float64] | str | None = None
    named: Named = field(default_factory=Named)
    measured: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return what the settings of the data set keep."""
        known = {name: value for name, value in self.arguments.items() if value is not None}
        known |= self.named.given()
        if isinstance(self.normals, np.ndarray):
            data = np.ascontiguousarray(self.normals)
            known["normals"] = f"{len(data)}, SHA-256 {hashlib.sha256(data.data).hexdigest()}"
        return known | {"measured": self.measured}

    def stored(self, folder: Path) -> Asked:
        """Return the same with the normals in a file: they may be larger than all the rest."""
        if not isinstance(self.normals, np.ndarray):
            return self
        path = folder / NORMALS
        with atomic_path(path) as temporary:
            np.save(temporary, self.normals, allow_pickle=False)
        return replace(self, normals=str(path))


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """What all shards of a run have in common.

    Attributes
    ----------
    folder : str
        The absolute path of the data set, the same on all machines.
    settings : Settings
        Those of the data set.
    asked : Asked
        What is asked of each part.
    limits : Limits
        Those of each part.
    again : bool
        Whether parts that failed in an earlier run are tried again.

    """

    folder: str
    settings: Settings
    asked: Asked
    limits: Limits
    again: bool = False

    def file(self, part: Input | ManifestRow) -> Path | None:
        """Return the path of the file of its own that a part gets, if there are any."""
        if self.settings.files is None:
            return None
        return Path(self.folder) / FILES / file_name(part.part, part.name, self.settings.files)


def file_name(part: int, name: str, suffix: str) -> str:
    """Return the name of the file of a part: its number, and what is harmless of its name."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    clean = re.sub(r"[^A-Za-z0-9_-]+", "-", plain).strip("-")[:LONGEST_NAME]
    return f"{part:06d}{'-' if clean else ''}{clean}{suffix}"


@cache
def normals_in(path: str) -> NDArray[np.float64]:
    """Return the normals that `Asked.stored` has written."""
    return np.load(path, allow_pickle=False)


def asked_of(
    request: Request,
    cells: Sequence[int] | None,
    on: str | None,
    measured: bool,
    named: Named | None = None,
) -> Asked:
    """Return what is asked of each part; `named` has the options with which files are read."""
    reach = request.reach
    arguments = {
        "count": request.count,
        "angle": request.angle,
        "coverage": request.coverage,
        "density": request.density,
        "reach": None if reach is None else [reach.axis.tolist(), reach.angle],
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


def limits_of(workers: int, seconds: float, memory: float | None) -> Limits:
    """Return the limits of each of so many processes."""
    share = SHARE * most_memory() / GIB / workers
    return Limits(
        positive_number(seconds, "time_limit", "seconds"),
        positive_number(share if memory is None else memory, "memory_limit", "GiB"),
    )
