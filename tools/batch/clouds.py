"""The same number of points of each part, in NumPy arrays, for training."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.samples.fields import COLUMNS, row_shape
from .folder import Settings
from .part_files import arrays_in, opened_part

__all__ = ["Clouds", "batches"]


@dataclass(frozen=True, slots=True, repr=False)
class Clouds:
    """Point clouds of the parts of a data set: a sequence, usable as a PyTorch map-style data set.

    Attributes
    ----------
    folder : Path
        The data set.
    settings : Settings
        The settings of the data set.
    parts : (P,) int64 array
        The indices of the parts that have samples.
    points : int
        The number of points of each part.
    types : dict of str to dtype
        The type of each requested field.
    seed : tuple of int or None
        The seed for drawing points; without it, the first points are taken.
    labels : dict of int to number or None
        The labels, keyed by part index.
    label_type : dtype or None
        The type of the labels.

    """

    folder: Path
    settings: Settings
    parts: NDArray[np.int64]
    points: int
    types: Mapping[str, np.dtype[Any]]
    seed: tuple[int, ...] | None
    labels: Mapping[int, Any] | None
    label_type: np.dtype[Any] | None

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
        return (*taken, part, *self._label(part))

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        return (self[place] for place in range(len(self)))

    def _rows(self, part: int, count: int) -> NDArray[np.int64]:
        """Return the indices of the samples to take: each once before any is repeated."""
        if self.seed is None:
            return np.arange(self.points, dtype=np.int64) % count
        rng = self.generator(0, part)
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

    def _label(self, part: int) -> tuple[Any, ...]:
        if self.labels is None or self.label_type is None:
            return ()
        if part not in self.labels:
            raise InputError(f"part {part} has no label; labels must have all parts.")
        value = self.labels[part]
        return (np.array(np.nan if value is None else value, dtype=self.label_type).item(),)

    def generator(self, *key: int) -> np.random.Generator:
        """Return an independent generator for each key."""
        seed = self.seed or ()
        # The key includes the length of the seed; otherwise (1,) and (1, 0) would be the same.
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(len(seed), *key)))


def batches(
    clouds: Clouds, parts: int, shard: tuple[int, int], drop_last: bool
) -> Iterator[tuple[NDArray[Any], ...]]:
    """Yield the batches of one worker, `parts` clouds each; a seed shuffles them."""
    count = len(clouds)
    order = np.arange(count) if clouds.seed is None else clouds.generator(1).permutation(count)
    index, workers = shard
    mine = order[index::workers]
    for start in range(0, len(mine), parts):
        places = mine[start : start + parts]
        if len(places) < parts and drop_last:
            return
        columns = list(zip(*(clouds[k] for k in places), strict=True))
        types = [np.dtype(np.int64)] if clouds.labels is None else [np.int64, clouds.label_type]
        fields = len(clouds.types)
        yield (
            *(np.stack(x) for x in columns[:fields]),
            *(np.array(x, kind) for x, kind in zip(columns[fields:], types, strict=True)),
        )
