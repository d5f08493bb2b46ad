"""Samples of numbers that are on no surface: files and other libraries only carry them."""

from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples.report import SamplingReport

from ...shapes import FIELDS


def make(
    count: int = 12,
    label: str = "torus",
    dtype: Any = np.float64,
    fields: Any = FIELDS,
    **changes: Any,
) -> gm.Samples:
    """Random numbers of all sizes, signed zeros and non-finite values among the curvatures."""
    rng = np.random.default_rng(count)
    # Not beyond 1e140: VTK's reader warns if it finds vectors whose squared length overflows.
    sizes = (-300, 140) if dtype == np.float64 else (-40, 15)
    arrays: dict[str, Any] = {
        name: rng.standard_normal((count, *tail)) * 10.0 ** rng.integers(*sizes, (count, *tail))
        for name, tail in [("points", (3,)), ("normals", (3,)), ("uv", (2,)), ("support", ())]
    }
    special = [
        -0.0,
        0.0,
        np.inf,
        -np.inf,
        np.nan,
        5e-324,
        -1.1,
        0.1,
        1e22,
        1e-5,
        123456789012345680,
    ]
    special = np.resize(special, count)
    arrays |= {"gaussian_curvature": special, "mean_curvature": special[::-1].copy()}
    arrays = {name: x.astype(dtype) for name, x in arrays.items()}
    arrays["normal_index"] = rng.integers(0, 2**31, count)
    arrays["patch_index"] = rng.integers(0, 99, count)
    arrays = {name: x for name, x in arrays.items() if name in fields}
    arrays["report"] = SamplingReport(label, 8, count, 99, 1.0 / 3.0, 1)
    return gm.Samples(**(arrays | changes))


NAMES = {"points": "x y z", "normals": "nx ny nz", "uv": "u v"}


def columns_of(samples: gm.Samples) -> dict[str, np.ndarray]:
    """Return the columns by their names, spelled out apart from the code under test."""
    return {
        name: column
        for field, array in samples.arrays().items()
        for name, column in zip(
            NAMES.get(field, field).split(), np.atleast_2d(array.T), strict=True
        )
    }


def ply_by_trimesh(path: Path) -> Any:
    """Return the elements of a .ply file, as trimesh reads them: vertices are rows with names."""
    trimesh = pytest.importorskip("trimesh")
    with open(path, "rb") as file:
        return trimesh.exchange.ply.load_ply(file)["metadata"]["_ply_raw"]
