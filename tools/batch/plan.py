"""The plan of a run: the requested samples of each part, their storage, and limits."""

import hashlib
import secrets
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.checks import listed, pair_of_cells
from ...runtime.onto_surface.on_surface import checked_place
from ...runtime.samples.fields import FLOAT_NAMES, PART_NAMES, checked_dtype, checked_fields
from ..density.request import Request
from ..sources.named import Named
from .folder import NORMALS, Settings

SECONDS = 600.0


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """The options that all parts of a run have in common.

    Attributes
    ----------
    settings : Settings
        The settings of the data set.
    arguments : dict
        The arguments of `sample` that are numbers and names: count, angle, coverage, density,
        reach, cells, on.
    named : Named
        The options for making surfaces from files.
    measured : bool
        Whether coverage and normal deviation are measured even where they were not requested.
    folder : Path
        The absolute path of the data set, the same on all machines.
    seconds : float
        The time limit of a part, in seconds.
    memory : float
        The memory limit of a process, in GiB.
    again : bool
        Whether parts that failed in an earlier run are tried again.
    run : str
        An identifier of this run.

    """

    settings: Settings
    arguments: dict[str, Any]
    named: Named = field(default_factory=Named)
    measured: bool = False
    folder: Path = Path()
    seconds: float = SECONDS
    memory: float = 1.0
    again: bool = False
    run: str = field(default_factory=secrets.token_hex)

    def normals(self) -> NDArray[np.float64] | None:
        """Return the prescribed normals, if any, read from a file, since they may be large."""
        return _read(self.folder / NORMALS) if "normals" in self.settings.asked else None


@cache
def _read(path: Path) -> NDArray[np.float64]:
    return np.load(path, allow_pickle=False)


def plan_of(
    request: Request,
    *,
    cells: Sequence[int] | None,
    on: str | None,
    measured: bool,
    fields: Sequence[str] | None,
    dtype: DTypeLike,
    named: Named | None = None,
) -> Plan:
    """Return the plan of a run; `named` has the options for reading files."""
    reach, named = request.reach, named or Named()
    arguments = {
        "count": request.count,
        "angle": request.angle,
        "coverage": request.coverage,
        "density": request.density,
        "reach": None if reach is None else list(reach._numbers),
        "cells": None if cells is None else list(pair_of_cells(cells)),
        "on": checked_place(on),
    }
    asked = {name: value for name, value in arguments.items() if value is not None}
    asked |= named.given() | {"measured": measured}
    if request.normals is not None:
        data = np.ascontiguousarray(request.normals)
        asked["normals"] = f"{len(data)}, SHA-256 {hashlib.sha256(data.data).hexdigest()}"
    settings = Settings.of_this_version(
        asked=asked,
        fields=FLOAT_NAMES if fields is None else _known_fields(fields, "normals" in asked),
        dtype=checked_dtype(dtype).name,
    )
    return Plan(settings, arguments, named, measured)


def _known_fields(fields: Sequence[str], given: bool) -> tuple[str, ...]:
    """Return the requested fields; fields that only CAD parts or only grids have are allowed."""
    names = listed(fields)
    if names is None:
        return checked_fields(fields)  # which raises
    others = [name for name in names if not isinstance(name, str) or name not in PART_NAMES]
    wanted = checked_fields(others, True, grid=True, given=given)
    return wanted + tuple(name for name in PART_NAMES if name in names)
