"""What is asked of each part of a data set: the arguments of `sample`."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.paths import atomic_path
from ..sources.named import Named
from .folder import NORMALS

__all__ = ["Asked", "normals_in"]


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """The arguments of `sample` for all parts, but for fields and types.

    Attributes
    ----------
    arguments : dict
        Numbers and names: count, angle, coverage, density, relax, cells, on.
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


@cache
def normals_in(path: str) -> NDArray[np.float64]:
    """Return the normals that `Asked.stored` has written."""
    return np.load(path, allow_pickle=False)
