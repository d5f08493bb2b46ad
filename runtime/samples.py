"""What a sampling returns: points, normals, parameters, curvatures, and how it went."""

from __future__ import annotations

import math
import operator
import os
from dataclasses import dataclass
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .spline import short_label

__all__ = ["ARRAY_NAMES", "Samples", "SamplingReport"]

# Every array of `Samples`: how many numbers belong to one sample, and their type.
_LAYOUT: dict[str, tuple[tuple[int, ...], type[np.generic]]] = {
    "points": ((3,), np.float64),
    "normals": ((3,), np.float64),
    "uv": ((2,), np.float64),
    "support": ((), np.float64),
    "gaussian_curvature": ((), np.float64),
    "mean_curvature": ((), np.float64),
    "normal_index": ((), np.int64),
    "patch_index": ((), np.int64),
}
ARRAY_NAMES: tuple[str, ...] = tuple(_LAYOUT)

# A share is a quotient of sums, so rounding may carry it this far beyond 0 or 1.
_SHARE_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class SamplingReport:
    """How a sampling went, as plain numbers.

    A number is None when nobody knows it: a .ply file that another program rewrote holds the
    samples, but no longer the report.

    - `surface`: label of the surface.
    - `normals`: how many normals were asked.
    - `samples`: how many samples came.
    - `patches`: how many patches the surface was cut into.
    - `invisible_share`: share of the surface's area that normals cannot see, from 0 to 1.
    - `degenerate_patches`: how many patches are developable up to the rounding of their
      coordinates, and so have no support function (those round a pole are among them).

    Raises InputError if a count is not an integer or is negative, the share is outside 0…1, or the
    label is not a string.
    """

    surface: str
    normals: int | None
    samples: int
    patches: int | None
    invisible_share: float | None
    degenerate_patches: int | None

    def __post_init__(self) -> None:
        if not isinstance(self.surface, str):
            raise InputError(f"surface must be a string, not {type(self.surface).__name__}.")
        for name in ("normals", "patches", "degenerate_patches"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else _count(name, value))
        object.__setattr__(self, "samples", _count("samples", self.samples))
        if self.invisible_share is not None:
            object.__setattr__(self, "invisible_share", _share(self.invisible_share))


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Samples:
    """N samples of a surface, one row each; lengths in the surface's unit L.

    Indexing with a boolean mask (N,), an index array or a slice gives the `Samples` of those
    rows, with the same report: `samples[samples.elliptic]`.

    - `points`: (N, 3) float64, points of the surface, in L.
    - `normals`: (N, 3) float64, unit normals at the points.
    - `uv`: (N, 2) float64, the surface's own parameters of the points.
    - `support`: (N,) float64, support function n·x, in L.
    - `gaussian_curvature`: (N,) float64, in 1/L². Its sign bit tells elliptic from hyperbolic, so
      −0.0 counts as hyperbolic.
    - `mean_curvature`: (N,) float64, in 1/L, positive for a sphere with outward normals.
    - `normal_index`: (N,) int64, row of the normals that were asked.
    - `patch_index`: (N,) int64, patch of the surface that holds the point.
    - `report`: how the sampling went.

    All arrays are C-contiguous; an array that is not is copied. Raises InputError if an array has
    another shape or dtype.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    uv: NDArray[np.float64]
    support: NDArray[np.float64]
    gaussian_curvature: NDArray[np.float64]
    mean_curvature: NDArray[np.float64]
    normal_index: NDArray[np.int64]
    patch_index: NDArray[np.int64]
    report: SamplingReport

    def __post_init__(self) -> None:
        count = (np.shape(self.points) or (0,))[0]
        for name, (tail, dtype) in _LAYOUT.items():
            array = _checked(name, getattr(self, name), (count, *tail), np.dtype(dtype))
            object.__setattr__(self, name, array)
        if not isinstance(self.report, SamplingReport):
            raise InputError(f"report must be a SamplingReport, not {type(self.report).__name__}.")

    @property
    def elliptic(self) -> NDArray[np.bool_]:
        """(N,) bool: where the Gaussian curvature is positive (its sign bit is clear)."""
        return ~self.hyperbolic

    @property
    def hyperbolic(self) -> NDArray[np.bool_]:
        """(N,) bool: where the Gaussian curvature is negative (its sign bit is set)."""
        return np.signbit(self.gaussian_curvature)

    @property
    def principal_curvatures(self) -> NDArray[np.float64]:
        """(N, 2) float64: the principal curvatures, in 1/L, the larger one first.

        They are computed from K and H. Where the two nearly agree, K and H determine their
        difference only to about 1e-8 relative to H; elsewhere both are accurate, however
        different their sizes. NaN where H² − K is not finite.
        """
        K, H = self.gaussian_curvature, self.mean_curvature
        with np.errstate(all="ignore"):
            square = H * H - K
            root = np.where(np.isfinite(square), np.sqrt(np.maximum(square, 0.0)), np.nan)
            # H − root would cancel when |K| is small against H²; K / (H + root) does not.
            far = H + np.copysign(root, H)
            near = np.where(root > 0.0, K / far, H)
        return np.stack([np.maximum(far, near), np.minimum(far, near)], axis=1)

    def summary(self) -> str:
        """One line: normals asked, samples came, their split, what normals cannot see."""
        report, came = self.report, f"{len(self):,} samples came"
        if len(self) != report.samples:
            came = f"{len(self):,} of the {report.samples:,} samples that came"
        asked = "" if report.normals is None else f"{report.normals:,} normals asked, "
        line = f"{asked}{came}: {self._split()}"
        if report.invisible_share is not None:
            line += f"; normals cannot see {100.0 * report.invisible_share:.2f} % of the surface"
        return line

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the samples to a .ply, .csv, .npz, .vtp or .xyz file; see `io.write_samples`."""
        from .io import write_samples

        write_samples(self, path)

    def __len__(self) -> int:
        return len(self.support)

    def __getitem__(self, key: ArrayLike | slice) -> Samples:
        rows = key if isinstance(key, slice) else _rows(key, len(self))
        return Samples(**{name: getattr(self, name)[rows] for name in _LAYOUT}, report=self.report)

    def __repr__(self) -> str:
        label = short_label(self.report.surface)
        return f"Samples({len(self):,} points on {label}: {self._split()})"

    def _split(self) -> str:
        hyperbolic = int(np.count_nonzero(self.hyperbolic))
        return f"{len(self) - hyperbolic:,} elliptic, {hyperbolic:,} hyperbolic"


def _count(name: str, value: SupportsIndex) -> int:
    """Return `value` as a plain int ≥ 0: a NumPy integer would not go into JSON."""
    try:
        count = operator.index(value)
    except TypeError:
        raise InputError(f"{name} must be an integer, not {value!r}.") from None
    if count < 0:
        raise InputError(f"{name} must not be negative, and is {count}.")
    return count


def _share(value: float) -> float:
    try:
        share = float(value)
    except (TypeError, ValueError):
        raise InputError(f"invisible_share must be a number, not {value!r}.") from None
    if not math.isfinite(share) or not -_SHARE_ROUNDING <= share <= 1.0 + _SHARE_ROUNDING:
        raise InputError(f"invisible_share must lie between 0 and 1, and is {share!r}.")
    return min(max(share, 0.0), 1.0)


def _checked(
    name: str, array: object, shape: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    if not isinstance(array, np.ndarray):
        raise InputError(f"{name} must be a NumPy array, not {type(array).__name__}.")
    if array.dtype != dtype or array.shape != shape:
        raise InputError(
            f"{name} must be a {dtype} array of shape {shape}, "
            f"not a {array.dtype} array of shape {array.shape}."
        )
    return np.ascontiguousarray(array)


def _rows(key: ArrayLike, count: int) -> NDArray[Any]:
    """Return a mask (count,) or an array of valid row numbers, (M,)."""
    rows = np.asarray(key)
    if rows.shape == (0,) and rows.dtype.kind == "f":
        rows = rows.astype(np.intp)  # NumPy takes an empty list for floats
    if rows.ndim != 1 or rows.dtype.kind not in "biu":
        raise InputError("samples are picked by a slice, a boolean mask or a 1-D index array.")
    if rows.dtype.kind == "b" and len(rows) != count:
        raise InputError(f"the mask has {len(rows)} entries, but there are {count} samples.")
    if rows.dtype.kind != "b" and len(rows) and not -count <= rows.min() <= rows.max() < count:
        raise InputError(f"an index is out of range: there are {count} samples.")
    return rows
