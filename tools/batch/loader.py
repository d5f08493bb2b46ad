"""Batches for training: the same number of points of each of several parts, in NumPy arrays."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import GaussmapWarning, InputError
from ...runtime.samples.fields import COLUMNS, row_shape
from .data_files import arrays_in, opened
from .folder import POINTS, Settings, shards_in

__all__ = ["Batch", "Loader"]

Batch = tuple[NDArray[Any], ...]
# From so many files row groups are taken in turn, if parts are shuffled.
FILES_AT_ONCE = 8


@dataclass(frozen=True, slots=True)
class Loader:
    """What the batches of a data set are made of; `Dataset.batches` documents it.

    `types` has the type of each field that is wanted, and `seed` is None for the order of the list.
    """

    folder: Path
    settings: Settings
    points: int
    parts: int
    types: Mapping[str, np.dtype[Any]]
    seed: tuple[int, ...] | None
    buffer: int
    shard: tuple[int, int]
    drop_last: bool
    labels: Mapping[int, Any] | None
    label_type: np.dtype[Any] | None

    def batches(self) -> Iterator[Batch]:
        """Yield the batches. The memory does not depend on the number of parts."""
        held: list[tuple[int, Batch]] = []
        for item in self._mixed():
            held.append(item)
            if len(held) == self.parts:
                yield self._batch(held)
                held = []
        if held and not self.drop_last:
            yield self._batch(held)

    def _batch(self, held: Sequence[tuple[int, Batch]]) -> Batch:
        numbers = np.array([part for part, _ in held], dtype=np.int64)
        arrays = [np.stack(column) for column in zip(*(x for _, x in held), strict=True)]
        if self.labels is None:
            return (*arrays, numbers)
        missing = [part for part, _ in held if part not in self.labels]
        if missing:
            raise InputError(f"part {missing[0]} has no label; labels must have all parts.")
        values = [self.labels[part] for part, _ in held]
        return (*arrays, numbers, np.array(values, dtype=self.label_type))

    def _mixed(self) -> Iterator[tuple[int, Batch]]:
        """Yield parts in the order of the batches: each is drawn from those in the buffer."""
        if self.seed is None:
            yield from self._read()
            return
        rng = self._generator(2, *self.shard)
        held: list[tuple[int, Batch]] = []
        for item in self._read():
            if len(held) < self.buffer:
                held.append(item)
                continue
            k = int(rng.integers(len(held)))
            chosen, held[k] = held[k], item
            yield chosen
        for k in rng.permutation(len(held)):
            yield held[k]

    def _read(self) -> Iterator[tuple[int, Batch]]:
        """Yield the chosen points of each part, as the files are read."""
        warned = False
        for table in self._row_groups():
            numbers = table["part"].to_numpy()
            columns = arrays_in(table, tuple(self.types))
            edges = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), len(numbers)]
            for start, stop in pairwise(edges):
                if start < stop:
                    part = int(numbers[start])
                    if stop - start < self.points and not warned:
                        warned = True
                        self._warn(part, stop - start)
                    rows = start + self._rows(part, stop - start)
                    yield part, tuple(self._taken(x, rows, name) for name, x in columns.items())

    def _warn(self, part: int, count: int) -> None:
        warnings.warn(
            f"part {part} has {count:,} samples, fewer than points={self.points}: some of them are "
            "repeated in its batch, as are those of other parts with fewer.",
            GaussmapWarning,
            stacklevel=5,  # where the batches are asked for
        )

    def _taken(self, columns: list[NDArray[Any]], rows: NDArray[Any], name: str) -> NDArray[Any]:
        taken = np.empty((self.points, *row_shape(name)), dtype=self.types[name])
        by_column = taken.reshape(self.points, -1)
        for k, column in enumerate(columns):
            by_column[:, k] = column[rows]
        return taken

    def _rows(self, part: int, count: int) -> NDArray[np.int64]:
        """Return which samples of a part are taken: each once, before any comes again."""
        if self.seed is None:
            return np.arange(self.points, dtype=np.int64) % count
        rng = self._generator(0, part)
        if count >= self.points:
            return rng.choice(count, self.points, replace=False)
        rounds = -(-self.points // count)
        return np.concatenate([rng.permutation(count) for _ in range(rounds)])[: self.points]

    def _row_groups(self) -> Iterator[Any]:
        """Yield row groups as tables: those of a few files in turn, if parts are shuffled."""
        shards = self._numbers()[::-1]
        rng = self._generator(3, *self.shard)
        names = ["part", *(column for name in self.types for column in COLUMNS[name])]
        waiting: list[tuple[int, list[int]]] = []
        while shards or waiting:
            while shards and len(waiting) < (1 if self.seed is None else FILES_AT_ONCE):
                shard = shards.pop()
                waiting.append((shard, self._groups_of(shard, rng)))
            k = int(rng.integers(len(waiting)))
            shard, groups = waiting[k]
            if not groups:
                del waiting[k]
                continue
            with opened(self.folder, self.settings, POINTS, shard) as file:
                table = file.read_row_group(groups.pop(), columns=names, use_threads=False)
            yield table

    def _groups_of(self, shard: int, rng: np.random.Generator) -> list[int]:
        """Return the row groups of a shard, the first one last."""
        with opened(self.folder, self.settings, POINTS, shard) as file:
            count = file.metadata.num_row_groups
        return list(range(count))[::-1] if self.seed is None else rng.permutation(count).tolist()

    def _numbers(self) -> list[int]:
        """Return the shards of this worker. All workers shuffle the same list."""
        numbers = shards_in(self.folder)
        if self.seed is not None:
            numbers = [numbers[k] for k in self._generator(1).permutation(len(numbers))]
        index, count = self.shard
        return numbers[index::count]

    def _generator(self, *key: int) -> np.random.Generator:
        """Return a generator of its own for each key."""
        seed = self.seed or ()
        # With the length of the seed: (1,) and (1, 0) would be the same otherwise.
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(len(seed), *key)))
