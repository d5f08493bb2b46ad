"""Data sets for tests, written without processes."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.batch.folder import Settings, opened
from gaussmap.tools.batch.manifest import FAILED, ManifestRow
from gaussmap.tools.batch.part_files import write_manifest, write_part

FIELDS = (
    *("points", "normals", "gaussian_curvature", "normal_index", "on_surface", "component"),
    "face_index",
)
# Of 13 parts two have no samples, and one has fewer than a batch takes.
COUNTS = (40, 0, 55, 3, 70, 50, 50, 60, 45, 50, 61, 50, 0)
BROKEN = 12
HELD = [part for part, count in enumerate(COUNTS) if count]


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
        component=None if of_cad else np.full(count, 1 + part % 4, np.uint8),
        face_index=rng.integers(9, size=count) if of_cad else None,
        report=SamplingReport(surface=f"part {part}", normals=None, samples=count, patches=None,
                              developable_share=None, developable_patches=None),
    )  # fmt: skip


def row_of(part: int, count: int) -> ManifestRow:
    if part == BROKEN:
        return ManifestRow(part, "broken", "a.step", "0", FAILED, error="no such file.")
    return ManifestRow(part, f"part {part}", "Surface", "0", samples=count, misfit=0.25)


def settings(**known) -> Settings:
    return Settings.of_this_version(**{"asked": {}, "fields": FIELDS} | known)


def write(folder: Path, counts: tuple[int, ...] = COUNTS, **known) -> gm.Dataset:
    """Write a data set with parts of so many samples."""
    how = settings(**known)
    with opened(folder, how):
        for part, count in enumerate(counts):
            samples = None if part == BROKEN else samples_of(part, count, how.dtype)
            write_part(folder, how, row_of(part, count), samples)
        write_manifest(folder, how, range(len(counts)))
    return gm.open_dataset(folder)


def waves(seed: int, wait: float = 0.0, log: Path | None = None) -> gm.Surface:
    """Return a surface; `log` gets a line for each time that it is sampled."""

    def position(u, v):
        if u.size > 17 * 17 and log is not None:
            with open(log, "a") as file:
                file.write(f"{seed}\n")
        time.sleep(wait)
        return np.stack([u, v, np.sin(u + seed) * np.cos(v)], axis=-1)

    return gm.Surface.from_callable(position, ((-1, 1), (-1, 1)), name=f"waves {seed}")


def wait_until(is_so: Callable[[], object], seconds: float = 60.0) -> None:
    late = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < late
        time.sleep(0.05)


def data_of(folder: Path) -> dict[str, Any]:
    """Return the bytes of all files of a data set."""
    return {str(x.relative_to(folder)): x.read_bytes() for x in folder.rglob("*") if x.is_file()}
