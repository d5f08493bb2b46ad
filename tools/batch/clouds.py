"""`Clouds`: the same number of points of each part of a data set, in NumPy arrays, for training."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.fields import COLUMNS, row_shape
from .folder import Settings
from .part_files import arrays_in, opened_part


@dataclass(frozen=True, slots=True, repr=False)
class Clouds:
    """Point clouds of the parts of a data set: a sequence, usable as a PyTorch map-style data set.

    Attributes
    ----------
    folder : Path
        The folder of the data set.
    settings : Settings
        The settings of the data set.
    parts : (C,) int64 array
        The indices of the C parts that have samples.
    points : int
        The number of points of each part.
    types : dict of str to dtype
        The type of each requested field.
    seed : tuple of int or None
        The seed for drawing points; without it, the first points are taken.
    labels : (P,) array or None
        A number for each of the P parts of the data set, failed ones included.

    """

    folder: Path
    settings: Settings
    parts: NDArray[np.int64]
    points: int
    types: Mapping[str, np.dtype[Any]]
    seed: tuple[int, ...] | None
    labels: NDArray[Any] | None

    def __len__(self) -> int:
        return len(self.parts)

    def __getitem__(self, place: SupportsIndex) -> tuple[Any, ...]:
        part = int(self.parts[place])
        names = [column for name in self.types for column in COLUMNS[name]]
        with opened_part(self.folder, self.settings, part) as (file, _):
            table = file.read(columns=names, use_threads=False)
        rows = self._rows(part, len(table))
        columns = arrays_in(table, tuple(self.types))
        taken = (self._taken(x, rows, name) for name, x in columns.items())
        label = () if self.labels is None else (self.labels[part].item(),)
        return (*taken, part, *label)

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        return (self[place] for place in range(len(self)))

    def _rows(self, part: int, count: int) -> NDArray[np.int64]:
        """Return the indices (points,) of the samples that are taken from a part.

        No sample is repeated before all have been taken.
        """
        if self.seed is None:
            return np.arange(self.points, dtype=np.int64) % count
        # The key includes the length of the seed; otherwise the seeds (1,) and (1, 0) would draw
        # the same points.
        key = (len(self.seed), 0, part)
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))
        if count >= self.points:
            return rng.choice(count, self.points, replace=False)
        rounds = -(-self.points // count)
        return np.concatenate([rng.permutation(count) for _ in range(rounds)])[: self.points]

    def _taken(self, columns: list[NDArray[Any]], rows: NDArray[Any], name: str) -> NDArray[Any]:
        taken = np.empty((self.points, *row_shape(name)), dtype=self.types[name])
        by_column = taken.reshape(self.points, -1)
        for k, column in enumerate(columns):
            by_column[:, k] = column[rows]
        return taken
