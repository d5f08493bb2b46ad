"""Data sets for tests, written without processes."""

from pathlib import Path

import gaussmap as gm
import numpy as np
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.batch.data_files import points_table
from gaussmap.tools.batch.folder import Settings, create
from gaussmap.tools.batch.manifest import FAILED, ManifestRow
from gaussmap.tools.batch.shards import Shard

FIELDS = ("points", "normals", "gaussian_curvature", "normal_index", "on_surface", "face_index")
# Of 13 parts two have no samples, and one has fewer than a batch takes.
COUNTS = (40, 0, 55, 3, 70, 50, 50, 60, 45, 50, 61, 50, 0)
BROKEN = 12
HELD = [part for part, count in enumerate(COUNTS) if count]
SEPARATE = 5  # parts of a shard


def samples_of(part: int, count: int, dtype: str = "float64") -> gm.Samples:
    """Return samples by which the part and the row are known again."""
    rng = np.random.default_rng(part)
    on_spline, of_cad = part % 3 == 1, part % 3 == 2
    return gm.Samples(
        points=np.column_stack([np.full(count, part), np.arange(count), rng.random(count)]).astype(
            dtype
        ),
        normals=rng.normal(size=(count, 3)).astype(dtype),
        gaussian_curvature=rng.normal(size=count).astype(dtype),
        normal_index=np.arange(count) - 1,
        on_surface=None if on_spline else rng.random(count) < 0.5,
        face_index=rng.integers(9, size=count) if of_cad else None,
        report=SamplingReport(surface=f"part {part}", normals=None, samples=count, patches=None,
                              developable_share=None, developable_patches=None),
    )  # fmt: skip


def row_of(part: int, count: int) -> ManifestRow:
    if part == BROKEN:
        return ManifestRow(part, "broken", "a.step", "0", FAILED, 2, error="no such file.")
    return ManifestRow(part, f"part {part}", "Surface", "0", samples=count, misfit=0.25)


def write(
    folder: Path,
    counts: tuple[int, ...] = COUNTS,
    dtype: str = "float64",
    compression: str = "zstd",
) -> gm.Dataset:
    """Write a data set with parts of so many samples."""
    known = Settings.of_this_version(
        asked={}, fields=FIELDS, dtype=dtype, parts_per_shard=SEPARATE, compression=compression
    )
    create(folder, known)
    for number in range(-(-len(counts) // SEPARATE)):
        parts = range(len(counts))[number * SEPARATE : (number + 1) * SEPARATE]
        shard = Shard(folder, number, known)
        for part in parts:
            table = points_table(samples_of(part, counts[part], dtype), part, shard.schema)
            shard.add(row_of(part, counts[part]), None if part == BROKEN else table)
        shard.commit(parts)
    return gm.open_dataset(folder)
