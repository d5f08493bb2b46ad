"""The arrays of samples: fields, types, shapes, and rows."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ..base.checks import checked_array, checked_rows, listed
from ..base.errors import InputError
from ..base.memory import check_memory
from ..base.tolerances import DERIVATIVE_ERROR, PATCH_ERROR
from ..spline.nets import AnySpline
from ..surface.surface import Surface
from .fields import (
    ARRAY_NAMES,
    COLUMNS,
    DERIVED,
    REAL_NAMES,
    Component,
    bytes_of,
    dtype_of,
    missing_fields,
    row_shape,
)
from .offset_of import OffsetOf
from .report import SamplingReport, common_report
from .whole import Whole

# The value of a field that was not requested; reading it raises MissingFieldError.
_NOT_ASKED: Any = None
# The types of the attributes that are not arrays.
_KINDS = {
    "report": (SamplingReport, "a SamplingReport"),
    "spline": (AnySpline | None, "a Spline or None"),
    "surface": (Surface | Whole | None, "a Surface or None"),
    "offset_of": (OffsetOf | None, "an OffsetOf or None"),
}


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class SampleArrays:
    """The data of `Samples`, which documents them."""

    points: NDArray[np.float64] = _NOT_ASKED
    normals: NDArray[np.float64] = _NOT_ASKED
    uv: NDArray[np.float64] = _NOT_ASKED
    support: NDArray[np.float64] = _NOT_ASKED
    gaussian_curvature: NDArray[np.float64] = _NOT_ASKED
    mean_curvature: NDArray[np.float64] = _NOT_ASKED
    normal_index: NDArray[np.int64] = _NOT_ASKED
    patch_index: NDArray[np.int64] | None = None
    on_surface: NDArray[np.bool_] | None = None
    uv_radius: NDArray[np.float64] | None = None
    component: NDArray[np.uint8] | None = None
    row: NDArray[np.int64] | None = None
    column: NDArray[np.int64] | None = None
    face_index: NDArray[np.int64] | None = None
    solid_index: NDArray[np.int64] | None = None
    other_normals: NDArray[np.float64] | None = None
    other_uv: NDArray[np.float64] | None = None
    other_face_index: NDArray[np.int64] | None = None
    report: SamplingReport = field(kw_only=True)
    spline: AnySpline | None = field(default=None, kw_only=True)
    surface: Surface | Whole | None = field(default=None, kw_only=True)
    offset_of: OffsetOf | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        arrays = {x: array for x in COLUMNS if (array := getattr(self, x)) is not None}
        if not arrays:
            raise InputError("samples need at least one array, such as points.")
        first = next(iter(arrays.values()))
        count = len(first) if isinstance(first, np.ndarray) and first.ndim else 0
        floating = _common_dtype(arrays)
        for name, array in arrays.items():
            shape, dtype = (count, *row_shape(name)), dtype_of(name, floating)
            object.__setattr__(self, name, checked_array(name, array, shape, dtype))
        for name, (kind, allowed) in _KINDS.items():
            if not isinstance(value := getattr(self, name), kind):
                raise InputError(f"{name} must be {allowed}, not {type(value).__name__}.")
        no_patches = self.report.proved is not None or isinstance(self.surface, Whole)
        for name in ARRAY_NAMES:
            if name not in arrays and not (no_patches and name == "patch_index"):
                object.__delattr__(self, name)  # an empty slot, so that __getattr__ raises

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        if name in COLUMNS or name in DERIVED:
            needed = [x for x in DERIVED.get(name, (name,)) if x not in self.fields]
            raise missing_fields(self.fields, needed, "" if name in COLUMNS else name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __reduce__(self) -> tuple[Any, ...]:
        base = self.offset_of
        if base is not None:
            base = replace(base, surface=_if_it_pickles(base.surface))
        spline = self.spline
        if spline is not None and not _pickles(spline.trim):
            spline = None
        known = {"report": self.report, "spline": spline, "offset_of": base}
        surface = _if_it_pickles(self.surface)
        return partial(type(self), **self.arrays(), **known, surface=surface), ()

    @classmethod
    def concatenate(cls, parts: Iterable[Self]) -> Self:
        """Join several parts into one, such as the chunks of a stream.

        Parameters
        ----------
        parts : iterable of Samples
            At least one; all with the same fields and dtype.

        Returns
        -------
        Samples
            The rows of all parts, in order. The report counts all of them, and has the sum of
            `proved` and the boxes `undecided` of all parts. Its label is "several surfaces" if the
            labels of the parts differ; other entries that differ are None. The spline, the surface
            and `offset_of` are kept if they are the same for all parts.

        Raises
        ------
        InputError
            If there is no part, or if the parts have different fields or dtypes.

        Examples
        --------
        >>> import gaussmap as gm
        >>> chunks = gm.sample_stream("torus", 200, chunk=64, cells=(16, 16))
        >>> len(gm.Samples.concatenate(chunks))
        200

        """
        pieces = listed(parts) or []
        if not all(isinstance(part, cls) for part in pieces) or not pieces:
            raise InputError("concatenate takes Samples, at least one.")
        kinds = {(part.fields, part.dtype) for part in pieces}
        if len(kinds) > 1:
            raise InputError("these samples do not fit together: they have other fields or dtypes.")
        arrays = {
            name: np.concatenate([getattr(part, name) for part in pieces])
            for name in pieces[0].fields
        }
        report = common_report([part.report for part in pieces], arrays)
        same: dict[str, Any] = {
            name: value if all(getattr(part, name) == value for part in pieces) else None
            for name in ("spline", "surface", "offset_of")
            for value in [getattr(pieces[0], name)]
        }
        return cls(**arrays, report=report, **same)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the fields by their names.

        Returns
        -------
        dict of str to array
            The fields of the samples, without copying.

        Examples
        --------
        >>> import gaussmap as gm
        >>> samples = gm.sample("torus", 50, fields=("points", "uv"), cells=(16, 16))
        >>> {name: array.shape for name, array in samples.arrays().items()}
        {'points': (50, 3), 'uv': (50, 2)}

        """
        return dict(self._named())

    def _named(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Yield the fields with their names."""
        for name in COLUMNS:
            with suppress(AttributeError):
                # Not with getattr: it would call __getattr__, which calls this method.
                array = object.__getattribute__(self, name)
                if array is not None:
                    yield name, array

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the fields of the samples, a tuple of str."""
        return tuple(self.arrays())

    @property
    def dtype(self) -> np.dtype[np.floating]:
        """The type of all numbers except the indices: float64 or float32."""
        return _common_dtype(self.arrays())

    @property
    def elliptic(self) -> NDArray[np.bool_]:
        """(N,) bool array: where the Gaussian curvature is positive (its sign bit is clear).

        Every sample, even a parabolic one, is either elliptic or hyperbolic. Σ sign K = χ/2 holds
        for these two sets if all samples are regular points; `GaussMap.degree` needs no condition.
        """
        return ~self.hyperbolic

    @property
    def parabolic(self) -> NDArray[np.bool_]:
        """(N,) bool array: where the Gaussian curvature is zero, up to rounding.

        The sign of K is meaningless there: on planes, cylinders, and along parabolic curves.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("cylinder", 100, cells=(16, 16)).parabolic.all()
        np.True_

        """
        return _is_parabolic(self)

    @property
    def hyperbolic(self) -> NDArray[np.bool_]:
        """(N,) bool array: where the Gaussian curvature is negative (its sign bit is set)."""
        return np.signbit(self.gaussian_curvature)

    @property
    def kind(self) -> NDArray[np.str_]:
        """(N,) str array: "normal" at prescribed normals, "grid", "edge", else "filling".

        "grid" is for samples on a grid, and "edge" for samples on sharp edges.
        """
        kinds = np.where(self.normal_index < 0, "filling", "normal")
        if self.row is not None:
            kinds[self.row >= 0] = "grid"
        if self.other_face_index is not None:
            kinds[self.other_face_index >= 0] = "edge"
        return kinds

    @property
    def _regular(self) -> NDArray[np.bool_]:
        """(N,) bool array: whether the component is regular: such samples represent some area."""
        component = self.arrays().get("component")
        return np.ones(len(self), bool) if component is None else component == Component.REGULAR

    @property
    def principal_curvatures(self) -> NDArray[np.floating]:
        """(N, 2) float64: the principal curvatures, in 1/L, the larger one first.

        They are computed from K and H. If they nearly agree, K and H determine their difference
        only to about 1e-8 relative to H (3e-4 if they are float32). Otherwise both are accurate,
        however different their sizes. NaN where H² − K is not finite, or where H² and K are too
        small for float64.
        """
        K, H = (x.astype(np.float64) for x in (self.gaussian_curvature, self.mean_curvature))
        with np.errstate(all="ignore"):
            square = H * H - K
            least = np.finfo(np.float64).tiny
            known = np.isfinite(square) & ((np.maximum(H * H, np.abs(K)) >= least) | (H == 0.0))
            root = np.where(known, np.sqrt(np.maximum(square, 0.0)), np.nan)
            # H − root would cancel when |K| is small against H²; K / (H + root) does not.
            far = H + np.copysign(root, H)
            near = np.where(root > 0.0, K / far, H)
            both = np.stack([np.maximum(far, near), np.minimum(far, near)], axis=1)
            return both.astype(self.dtype, copy=False)

    @property
    def slope(self) -> NDArray[np.floating]:
        """(N,) float64: the angles between the normals and +z, in degrees; 0 is level."""
        x, y, z = self.normals.T
        return np.degrees(np.arctan2(np.hypot(x, y), z))

    @property
    def aspect(self) -> NDArray[np.floating]:
        """(N,) float64: directions that slopes face, in degrees clockwise from +y; NaN if level."""
        x, y, _ = self.normals.T
        return np.where(np.hypot(x, y) > 0.0, np.degrees(np.arctan2(x, y)) % 360.0, np.nan)

    def __len__(self) -> int:
        return len(next(self._named())[1])

    def __array__(
        self, dtype: DTypeLike | None = None, copy: bool | None = None
    ) -> NDArray[np.floating]:
        """Return the points, for `numpy.asarray`."""
        return np.array(self.points, dtype=dtype, copy=copy)

    def __iter__(self) -> Iterator[Self]:
        """Yield the samples one by one, as Samples of length 1."""
        return (self[k : k + 1] for k in range(len(self)))

    def __getitem__(self, key: ArrayLike | slice) -> Self:
        """Return the samples that a slice, a mask, an array of indices or one index selects."""
        rows = key if isinstance(key, slice) else checked_rows(key, len(self))
        arrays = self.arrays()
        if not isinstance(rows, slice) and len(rows) > len(self):  # indices may be repeated
            check_memory("stored", len(rows), bytes_of(arrays, _common_dtype(arrays)))
        arrays = {name: array[rows] for name, array in arrays.items()}
        return type(self)(
            **arrays, report=self.report,
            spline=self.spline, surface=self.surface, offset_of=self.offset_of,
        )  # fmt: skip


def _if_it_pickles(surface: Whole | Surface | None) -> Any:  # noqa: ANN401 - of the same type
    """Return a surface, or None if it cannot be pickled, as with a lambda."""
    return surface if _pickles(surface) else None


def _pickles(value: object) -> bool:
    try:
        pickle.dumps(value)
    except Exception:  # pickling may raise anything
        return False
    return True


def _common_dtype(arrays: Mapping[str, object]) -> np.dtype[np.floating]:
    """Return float32 if all real fields are float32, otherwise float64."""
    types = {getattr(arrays[name], "dtype", None) for name in REAL_NAMES if name in arrays}
    return np.dtype(np.float32 if types == {np.dtype(np.float32)} else np.float64)


def _is_parabolic(samples: SampleArrays) -> NDArray[np.bool_]:
    """Return whether a principal curvature is zero, up to rounding, as booleans (N,).

    If κ₁ and κ₂ have errors up to t, that of κ₁ κ₂ is at most t (|κ₁| + |κ₂| + t); if κ₂ ≈ 0, then
    |κ₁| + |κ₂| = 2|H|. Unknown H is assumed to be 1/D, where D is the diagonal of the bounding box.
    """
    K = samples.gaussian_curvature.astype(np.float64)
    diagonal, error = _size_and_error(samples)
    if not diagonal > 0.0:
        return np.zeros(len(K), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        bend = np.ones_like(K)
        if "mean_curvature" in samples.fields:
            bend = np.abs(samples.mean_curvature.astype(np.float64)) * diagonal
        return np.abs(K) * diagonal * diagonal <= error * (2.0 * bend + error)


def _size_and_error(samples: SampleArrays) -> tuple[float, float]:
    """Return the diagonal D of the bounding box, and the error of curvatures in units of 1/D.

    The box contains the spline, or the points if there is no spline. If there are no points either,
    both numbers are 0.
    """
    spline = samples.spline
    if spline is not None:
        diagonal, cells = spline.extent
        largest = spline._largest
    elif "points" in samples.fields and len(samples.points) > 0:
        points, cells = samples.points.astype(np.float64), 0
        diagonal = math.hypot(*np.ptp(points, axis=0))  # squares of coordinates may overflow
        largest = float(np.abs(points).max())
    else:
        return 0.0, 0.0
    rounding = float(np.spacing(largest)) / (diagonal or 1.0)
    return diagonal, rounding * max(DERIVATIVE_ERROR, PATCH_ERROR * cells**2)
