"""Points of a surface at given normals, all of them, with a proof."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.memory import check_memory
from ..kernels.forms import patches_at
from ..samples.fields import FLAG_NAMES, PROVED_NAMES, bytes_of, dtype_of
from ..samples.report import UndecidedNormal
from ..search.proved import CELLS, KINDS, ProvedIndex, ProvedPlaces, Undecided
from ..spline.inside import samples_inside
from ..spline.spline import Spline
from ..surface.surface import Surface
from .newton import evaluate_on_surface
from .on_spline import Fields, FieldsOfSamples

__all__ = ["Proof", "index_of", "proof_of", "proved_samples"]

# The fields that follow from the 2-jets of the surface.
EVALUATED = {"points", "support", "gaussian_curvature", "mean_curvature"}


class Proof(NamedTuple):
    """For how many normals all points are known, and where other normals may have further ones."""

    proved: int
    undecided: tuple[UndecidedNormal, ...]


def index_of(
    surface: Surface, threads: int | None = None, cells: tuple[int, int] = CELLS
) -> ProvedIndex | None:
    """Return the index of a surface; None if its derivatives have no bounds, next to poles, too."""
    if surface.tape is None:
        return None
    index = ProvedIndex.of(surface.tape, surface.domain, surface.boundary, cells, threads)
    if index is None:
        return None
    poles = sum(end == "pole" for ends in surface.boundary for end in ends)
    whole = len(index.discs) == poles and len(index.unbounded) == 0
    return index if whole else None


def proved_samples(
    surface: Surface,
    spline: Spline,
    index: ProvedIndex,
    normals: NDArray[np.float64],
    fields: Sequence[str],
    dtype: DTypeLike,
    threads: int | None,
) -> tuple[FieldsOfSamples, Proof]:
    """Return fields of all points that have unit normals (S, 3), by normal, and the proof."""
    found = index.query(normals, threads)
    check_memory("stored", len(found.numbers), bytes_of(fields, dtype))
    arrays = _arrays(surface, spline, normals, found, set(fields), threads)
    arrays = samples_inside(spline.trim, arrays, tuple(arrays))
    kept = {x: arrays[x].astype(dtype_of(x, dtype), copy=False) for x in fields}
    return FieldsOfSamples(kept, 0), proof_of(len(normals), found.undecided)


def _arrays(
    surface: Surface,
    spline: Spline,
    normals: NDArray[np.float64],
    found: ProvedPlaces,
    fields: set[str],
    threads: int | None,
) -> Fields:
    """Return those fields that are wanted, and the parameters."""
    count, uv = len(found.numbers), found.uv
    arrays: Fields = {
        "uv": uv,
        "normal_index": found.numbers,
        FLAG_NAMES[0]: np.ones(count, dtype=np.bool_),
        PROVED_NAMES[0]: found.radius,
    }
    if fields & {"normals", "support"}:
        arrays["normals"] = normals[found.numbers]
    if fields & EVALUATED:
        points, _, gaussian, mean = evaluate_on_surface(surface, spline, uv, threads)
        arrays |= {"points": points, "mean_curvature": mean}
        arrays["gaussian_curvature"] = np.copysign(gaussian, found.sign)
    if "support" in fields:
        arrays["support"] = np.einsum("kx,kx->k", arrays["points"], arrays["normals"])
    if "patch_index" in fields:
        patches, places = np.empty(count, dtype=np.int64), np.empty((count, 2))
        frame = spline.frame
        patches_at(*spline.cells, (uv - frame[:2]) / frame[2:], patches, places)
        arrays["patch_index"] = patches
    return arrays


def proof_of(count: int, open_: Undecided, face: int | None = None) -> Proof:
    """Return the proof for a number of normals, of which some are open; on a face of a part."""
    undecided = tuple(
        UndecidedNormal(number, tuple(box), KINDS[kind], border, face)
        for number, box, kind, border in zip(*(x.tolist() for x in open_), strict=True)
    )
    return Proof(count - len(np.unique(open_.numbers)), undecided)
