"""`Dataset`: reads the samples of many parts, and their manifest, from a folder."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ...runtime.base.checks import listed, real_values, whole_number
from ...runtime.base.errors import GaussmapWarning, InputError, UnknownNameError
from ...runtime.base.extras import check_extra
from ...runtime.base.wording import plural
from ...runtime.samples.fields import COLUMNS, UNITS, checked_dtype, dtype_of
from ..files.paths import PathLike, checked_path
from .clouds import Clouds
from .folder import MANIFEST, Settings, checked_names, part_path, parts_in, read_settings
from .manifest import COLUMNS as MANIFEST_COLUMNS
from .manifest import FAILED, ManifestRow, manifest_table
from .part_files import arrays_in, opened_manifest, opened_part, rows_of, stacked

if TYPE_CHECKING:
    import pyarrow

    from ...runtime.samples.samples import Samples


def open_dataset(folder: PathLike) -> Dataset:
    """Open a data set: a folder that `sample_many` has written with ``out=folder``.

    Parameters
    ----------
    folder : str or Path
        The folder. A run may still be writing to it: finished parts are visible at once.

    Returns
    -------
    Dataset
        The data set. Its files are read when they are needed.

    Raises
    ------
    MissingExtraError
        Without the extra `batch`.
    FileError
        If the folder holds no data set, or one of another version of gaussmap's format.

    Examples
    --------
    >>> import gaussmap as gm
    >>> # made by gm.sample_many(["torus", "sphere", "ellipsoid"], 500, out="dataset")
    >>> dataset = gm.open_dataset("dataset")
    >>> dataset.summary()
    '3 parts with 1,500 samples'

    """
    check_extra("pyarrow", "batch", "a data set")
    from_folder = checked_path(folder)
    return Dataset(from_folder, read_settings(from_folder))


@dataclass(frozen=True, slots=True, repr=False)
class Dataset:
    """The samples of many parts, in a folder; `open_dataset` opens it.

    Parts are numbered as in the list of `sample_many`, from 0: ``len(dataset)`` is the number of
    all parts, failed ones included (during a run, of finished parts), ``dataset[part]`` are the
    samples of one part, as `samples` returns them, and ``dataset[-1]`` are those of the last part.
    Iteration goes over the samples of all parts that did not fail.

    Attributes
    ----------
    folder : Path
        The folder.
    settings : Settings
        The settings that all parts have in common: ``settings.asked`` holds the requested
        arguments, ``settings.dtype`` the type of the numbers.

    Notes
    -----
    The columns, and how pandas, Polars and DuckDB read the files, are described in
    docs/datasets.md.

    Examples
    --------
    >>> import gaussmap as gm
    >>> # made by gm.sample_many(["torus", "sphere", "ellipsoid"], 500, out="dataset")
    >>> dataset = gm.open_dataset("dataset")
    >>> len(dataset), dataset.folder.name, dataset.settings.dtype
    (3, 'dataset', 'float64')
    >>> dataset.fields[:3], dataset.units["gaussian_curvature"]
    (('points', 'normals', 'uv'), '1/L^2')
    >>> dataset[1]
    Samples(500 points on sphere: ...)
    >>> [samples.report.surface for samples in dataset]
    ['torus', 'sphere', 'ellipsoid']

    """

    folder: Path
    settings: Settings

    @property
    def fields(self) -> tuple[str, ...]:
        """The fields of the samples, a tuple of str; a part may lack some of these fields."""
        return self.settings.fields

    @property
    def units(self) -> dict[str, str]:
        """The units of fields by name; L is the part's `unit_of_length` in the manifest."""
        return {name: UNITS[name] for name in self.fields if name in UNITS}

    def __len__(self) -> int:
        if not (self.folder / MANIFEST).exists():
            return len(parts_in(self.folder))
        with opened_manifest(self.folder) as file:
            return file.metadata.num_rows

    def __getitem__(self, part: SupportsIndex) -> Samples:
        number = whole_number(part, "part", least=-len(self))
        return self.samples(number % len(self) if number < 0 else number)

    def __iter__(self) -> Iterator[Samples]:
        table = self.manifest(("part", "status")).to_pylist()
        return (self.samples(row["part"]) for row in table if row["status"] != FAILED)

    def __hash__(self) -> int:
        return hash(self.folder)

    def __repr__(self) -> str:
        return f"Dataset({str(self.folder)!r})"

    def summary(self) -> str:
        """Return one line: the numbers of parts and of samples.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.open_dataset("dataset").summary()
        '3 parts with 1,500 samples'

        """
        table = self.manifest(("status", "samples"))
        failed = int((np.asarray(table["status"]) == FAILED).sum())
        samples = int(np.asarray(table["samples"]).sum())
        some = f", {failed:,} of which failed," if failed else ""
        return f"{plural(len(table), 'part')}{some} with {samples:,} samples"

    def manifest(self, columns: Sequence[str] | None = None) -> pyarrow.Table:
        """Return the manifest: a row for each part, with its status and results.

        Parameters
        ----------
        columns : sequence of str, optional
            The requested columns; all by default.

        Returns
        -------
        pyarrow.Table
            The rows in the order of the parts. The metadata of the columns hold their meanings and
            units.

        Raises
        ------
        MissingExtraError
            Without the extra `batch`.
        UnknownNameError
            For a column that does not exist.
        FileError
            If a file cannot be read.

        Examples
        --------
        >>> import gaussmap as gm
        >>> table = gm.open_dataset("dataset").manifest(["part", "name", "status", "samples"])
        >>> table.to_pylist()[1]
        {'part': 1, 'name': 'sphere', 'status': 'ok', 'samples': 500}

        """
        names = tuple(MANIFEST_COLUMNS)
        if columns is not None:
            names = checked_names(columns, names, "column")
        if not (self.folder / MANIFEST).exists():  # a run is still going on, or was stopped
            rows = rows_of(self.folder, self.settings, parts_in(self.folder))
            return manifest_table(rows).select(names)
        with opened_manifest(self.folder) as file:
            return file.read(columns=list(names), use_threads=False).select(names)

    def samples(self, part: SupportsIndex) -> Samples:
        """Return the samples of a part.

        Parameters
        ----------
        part : int
            The index of the part.

        Returns
        -------
        Samples
            The samples, in the order of `sample`. The report holds the values that are in the
            manifest, and None for all others.

        Raises
        ------
        UnknownNameError
            If there is no such part, or if it failed.
        FileError
            If a file cannot be read.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.open_dataset("dataset").samples(0)
        >>> samples
        Samples(500 points on torus: ...)

        """
        number = whole_number(part, "part", least=0)
        if not part_path(self.folder, number).exists():
            raise UnknownNameError(f"'{self.folder}' has no part {number}.")
        with opened_part(self.folder, self.settings, number) as (file, row):
            table = file.read(use_threads=False)
        if row.status == FAILED:
            raise UnknownNameError(f"part {number} ('{row.name}') has failed: {row.error}")
        held = [name for name in self.fields if table[COLUMNS[name][0]].null_count < len(table)]
        wanted = held or self.fields  # a part without samples has empty arrays
        arrays = {name: stacked(x, name) for name, x in arrays_in(table, wanted).items()}
        return _samples(arrays, row)

    def clouds(
        self,
        points: int = 2048,
        *,
        fields: Sequence[str] = ("points", "normals"),
        shuffle: int | Sequence[int] | None = None,
        dtype: DTypeLike | None = None,
        labels: ArrayLike | None = None,
    ) -> Clouds:
        """Return the same number of points of each part, for training: a data set for PyTorch.

        Parameters
        ----------
        points : int, default 2048
            The number of points of each part. If a part has fewer samples, they are repeated, each
            about equally often, and a warning says so once.
        fields : sequence of str, default ("points", "normals")
            The requested fields of the samples. A field that a part lacks is NaN, −1, False or 0.
        shuffle : int or sequence of int, optional
            A seed for drawing points at random, without repetition if the part has enough.
            ``shuffle=(seed, epoch)`` draws other points in each epoch. Without a seed, the first
            points are taken.
        dtype : {float32, float64}, optional
            The type of the numbers; that of the data set by default.
        labels : (P,) array_like, optional
            A number for each of the P parts of the data set, failed ones included.

        Returns
        -------
        A sequence, usable as a map-style data set of PyTorch: ``clouds[k]`` is a tuple of an array
        (points, 3) or (points,) for each field, the index of the part, and its label, if any;
        ``len(clouds)`` is the number of parts that have samples. A file is read when its part is
        accessed; the arrays are contiguous, writable and never reused.

        Raises
        ------
        InputError
            If an argument is out of range.
        UnknownNameError
            If the data set has no such field.
        FileError
            If a file cannot be read.

        Warns
        -----
        GaussmapWarning
            If a part has fewer samples than `points`.

        Notes
        -----
        The points drawn from a part depend only on the seed, the index of the part, the number of
        its samples, and `points`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> clouds = gm.open_dataset("dataset").clouds(256, dtype="float32", labels=[0, 1, 1])
        >>> points, normals, part, label = clouds[2]
        >>> len(clouds), points.shape, part, label
        (3, (256, 3), 2, 1)
        >>> # torch.utils.data.DataLoader(clouds, batch_size=16, shuffle=True, num_workers=4)

        """
        count, types = whole_number(points, "points"), self._types(fields, dtype)
        seed, table = _checked_seed(shuffle), self.manifest(("part", "samples"))
        numbers, samples = (np.asarray(table[name]) for name in ("part", "samples"))
        known = (
            None if labels is None else _checked_labels(labels, int(numbers.max(initial=-1)) + 1)
        )
        few = (samples > 0) & (samples < count)
        if few.any():
            part, held = numbers[few][0], samples[few][0]
            warnings.warn(
                f"part {part} has {held:,} samples, fewer than {count} points: some of them are "
                "repeated, as are those of other parts with fewer.",
                GaussmapWarning,
                stacklevel=2,
            )
        return Clouds(self.folder, self.settings, numbers[samples > 0], count, types, seed, known)

    def _types(self, fields: Sequence[str], dtype: DTypeLike | None) -> dict[str, np.dtype[Any]]:
        number = checked_dtype(self.settings.dtype if dtype is None else dtype)
        names = self.fields if fields is None else checked_names(fields, self.fields, "field")
        return {name: dtype_of(name, number) for name in names}


def _samples(arrays: dict[str, NDArray[Any]], row: ManifestRow) -> Samples:
    # Imported here because these modules load Numba, which reading clouds does not need.
    from ...runtime.samples.report import SamplingReport
    from ...runtime.samples.samples import Samples

    report = SamplingReport(
        surface=row.name, normals=None, samples=row.samples, patches=None,
        developable_share=None, developable_patches=None, coverage=row.coverage, angle=row.angle,
        fit_distance=row.misfit, index=row.part, unit=row.unit_of_length or None,
    )  # fmt: skip
    known: dict[str, Any] = {**arrays}
    return Samples(**known, report=report)


def _checked_seed(seed: int | Sequence[int] | None) -> tuple[int, ...] | None:
    if seed is None:
        return None
    if isinstance(seed, Sequence) and (numbers := listed(seed)):
        return tuple(whole_number(x, "shuffle", least=0) for x in numbers)
    return (whole_number(seed, "shuffle", least=0),)


def _checked_labels(labels: ArrayLike, parts: int) -> NDArray[Any]:
    values = real_values(labels, "labels")
    if values.shape != (parts,):
        raise InputError(
            f"labels must be an array with one number for each of {parts:,} parts, of the shape "
            f"({parts},), not {values.shape}."
        )
    return values
