"""What a sampling returns: points, normals, parameters, curvatures, and how it went."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from dataclasses import fields as dataclass_fields
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import checked_array
from .errors import InputError, MissingFieldError, shown
from .fields import ARRAY_NAMES, DERIVED, FLOAT_NAMES, row_shape
from .spline import Spline, short_label

if TYPE_CHECKING:
    import open3d  # pyright: ignore[reportMissingImports]
    import pandas
    import pyvista
    import trimesh

    from .meshes.mesh import Mesh

__all__ = [
    "ARRAY_NAMES",
    "Samples",
    "SamplingReport",
    "count_infinite",
    "have_large_squares",
    "rows_of",
]

# What a field is set to that was not asked for; reading it raises MissingFieldError.
_NOT_ASKED: Any = None

# A share is a quotient of sums, so rounding may carry it this far beyond 0 or 1.
_SHARE_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class SamplingReport:
    """A report on a sampling.

    A number is None if it is unknown: a .ply file that another program rewrote has the samples, but
    not the report.

    - `surface`: label of the surface.
    - `normals`: the number of prescribed normals.
    - `samples`: the number of samples.
    - `patches`: the number of patches of the spline.
    - `invisible_share`: the developable share of the area (K ≈ 0), from 0 to 1, which no set of
      normals samples.
    - `degenerate_patches`: the number of patches that are developable up to the rounding of their
      coordinates, and so have no support function (those at a pole are among them).
    - `coverage`: a bound of the distance of any point of the surface from the nearest sample, in L.
      Known if a coverage was requested; see also `Samples.coverage`.
    - `angle`: a bound of the angle, in degrees, between the normal of any point of the surface and
      that of the sample nearest in normal. Known if an angle was requested.
    - `infinite_curvatures`: the number of samples with infinite Gaussian curvature: at singular
      points of the spline, which a coarse one may have, and where 1/L² exceeds the largest number
      of its type, on surfaces smaller than 1e-154 (1e-19 with float32). Known if
      `gaussian_curvature` was requested.

    Raises InputError if a count is not an integer or is negative, the share is outside 0…1, or the
    label is not a string.
    """

    surface: str
    normals: int | None
    samples: int
    patches: int | None
    invisible_share: float | None
    degenerate_patches: int | None
    coverage: float | None = None
    angle: float | None = None
    infinite_curvatures: int | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.surface, str):
            raise InputError(f"surface must be a string, not {type(self.surface).__name__}.")
        for name in ("normals", "patches", "degenerate_patches", "infinite_curvatures"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else _count(name, value))
        object.__setattr__(self, "samples", _count("samples", self.samples))
        if self.invisible_share is not None:
            object.__setattr__(self, "invisible_share", _share(self.invisible_share))
        for name in ("coverage", "angle"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else _distance(name, value))


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Samples:
    """N samples of a surface, one row each; lengths in the surface's unit L.

    Indexing with a boolean mask (N,), an index array or a slice gives the `Samples` of those
    rows, with the same report and spline: `samples[samples.elliptic]`. `Samples.concatenate` is
    the other way.

    - `points`: (N, 3) float64, points of the surface, in L.
    - `normals`: (N, 3) float64, unit normals at the points.
    - `uv`: (N, 2) float64, the surface's own parameters of the points.
    - `support`: (N,) float64, support function n·x, in L.
    - `gaussian_curvature`: (N,) float64, in 1/L². It is hyperbolic where the sign bit is set, so
      −0.0 counts as hyperbolic. On surfaces smaller than 1e-154 it may be infinite, on those larger
      than 1e154 zero: float64 does not hold it.
    - `mean_curvature`: (N,) float64, in 1/L, positive for a sphere with outward normals.
    - `normal_index`: (N,) int64, row of the prescribed normals; −1 for a sample that fills a gap.
    - `patch_index`: (N,) int64, patch of the spline that contains the point.
    - `report`: a report on the sampling.
    - `spline`: the spline that was sampled; None if it is unknown, as for samples from a file.

    With `dtype=numpy.float32`, all numbers except the indices are float32. Fields that were not
    requested (`fields` of `sample`) are missing: reading them raises MissingFieldError, an
    AttributeError.

    All arrays are C-contiguous; an array that is not is copied. Raises InputError if an array has
    another shape or dtype, or if there is none.
    """

    points: NDArray[np.float64] = _NOT_ASKED
    normals: NDArray[np.float64] = _NOT_ASKED
    uv: NDArray[np.float64] = _NOT_ASKED
    support: NDArray[np.float64] = _NOT_ASKED
    gaussian_curvature: NDArray[np.float64] = _NOT_ASKED
    mean_curvature: NDArray[np.float64] = _NOT_ASKED
    normal_index: NDArray[np.int64] = _NOT_ASKED
    patch_index: NDArray[np.int64] = _NOT_ASKED
    report: SamplingReport = field(kw_only=True)
    spline: Spline | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        arrays = {name: getattr(self, name) for name in ARRAY_NAMES}
        arrays = {name: array for name, array in arrays.items() if array is not None}
        if not arrays:
            raise InputError("samples need at least one array, such as points.")
        count = (np.shape(next(iter(arrays.values()))) or (0,))[0]
        floating = _common_dtype(arrays)
        for name in ARRAY_NAMES:
            if name in arrays:
                dtype = floating if name in FLOAT_NAMES else np.dtype(np.int64)
                array = checked_array(name, arrays[name], (count, *row_shape(name)), dtype)
                object.__setattr__(self, name, array)
            else:
                object.__delattr__(self, name)  # an empty slot, for which __getattr__ speaks
        if not isinstance(self.report, SamplingReport):
            raise InputError(f"report must be a SamplingReport, not {type(self.report).__name__}.")
        if not isinstance(self.spline, Spline | None):
            raise InputError(f"spline must be a Spline or None, not {type(self.spline).__name__}.")

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        if name in ARRAY_NAMES or name in DERIVED:
            needed = [x for x in DERIVED.get(name, (name,)) if x not in self.fields]
            subject = "" if name in ARRAY_NAMES else f"{name} needs {' and '.join(needed)}, but "
            raise MissingFieldError(
                f"{subject}these samples hold {', '.join(self.fields)} only; "
                f"add {' and '.join(repr(x) for x in needed)} to fields=... when sampling."
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (self.arrays(), self.report, self.spline)

    @classmethod
    def concatenate(cls, parts: Iterable[Samples]) -> Samples:
        """Return the samples of several parts, one after the other, such as those of a stream.

        The report counts all of them; what the parts' reports do not agree about is None in it.
        The spline is kept if all parts have the same.
        Raises InputError if there is no part, or if the parts have different fields or dtypes.
        """
        try:
            pieces = list(parts)
        except TypeError:
            pieces = []
        if not all(isinstance(part, Samples) for part in pieces) or not pieces:
            raise InputError("concatenate takes Samples, at least one.")
        kinds = {(part.fields, part.dtype) for part in pieces}
        if len(kinds) > 1:
            raise InputError("these samples do not fit together: they have other fields or dtypes.")
        arrays = {
            name: np.concatenate([getattr(part, name) for part in pieces])
            for name in pieces[0].fields
        }
        report = _common_report([part.report for part in pieces], arrays)
        common = all(part.spline is pieces[0].spline for part in pieces)
        return cls(**arrays, report=report, spline=pieces[0].spline if common else None)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the fields that there are by their names, as they are and not as copies."""
        found: dict[str, NDArray[Any]] = {}
        for name in ARRAY_NAMES:
            with suppress(AttributeError):
                # Past __getattr__, which asks here what there is.
                found[name] = object.__getattribute__(self, name)
        return found

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the arrays that these samples hold."""
        return tuple(self.arrays())

    @property
    def dtype(self) -> np.dtype[np.floating]:
        """The type of all numbers but the indices: float64 or float32."""
        return _common_dtype(self.arrays())

    @property
    def elliptic(self) -> NDArray[np.bool_]:
        """(N,) bool: where the Gaussian curvature is positive (its sign bit is clear)."""
        return ~self.hyperbolic

    @property
    def hyperbolic(self) -> NDArray[np.bool_]:
        """(N,) bool: where the Gaussian curvature is negative (its sign bit is set)."""
        return np.signbit(self.gaussian_curvature)

    @property
    def kind(self) -> NDArray[np.str_]:
        """(N,) text: "normal" for what the normals gave, "coverage" for what was added."""
        return np.where(self.normal_index < 0, "coverage", "normal")

    @property
    def principal_curvatures(self) -> NDArray[np.floating]:
        """(N, 2) float64: the principal curvatures, in 1/L, the larger one first.

        They are computed from K and H. Where the two nearly agree, K and H determine their
        difference only to about 1e-8 relative to H (3e-4 if they are float32); elsewhere both are
        accurate, however different their sizes. NaN where H² − K is not finite, or where H² and K
        are too small for float64.
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

    def progressive(self) -> Samples:
        """Return the same samples in an order in which every prefix is well distributed.

        The first ones are far apart relative to the local spacing of the samples; the next ones
        halve the gaps, and so on. Any prefix can be used: `samples[:1000]`. Spacings below a
        thousandth of the median count as that. Needs the fields points and normals, else
        MissingFieldError.
        """
        from .density.progressive import progressive_order

        points, normals = (x.astype(np.float64) for x in (self.points, self.normals))
        return self[progressive_order(points, normals)]

    def summary(self) -> str:
        """One line: how many samples, where they come from, and how far places are from them.

        Such as "10,000 samples: 4,300 at 2,150 prescribed normals, 5,700 filling gaps (6,197
        elliptic, 3,803 hyperbolic)".
        """
        report, split = self.report, self._split().removeprefix(": ").strip(" ()")
        line = f"{len(self):,} samples{self._origin()} ({split})"
        if len(self) != report.samples:
            line = f"{len(self):,} of {report.samples:,}" + line.removeprefix(f"{len(self):,}")
        if report.angle is not None:
            line += f"; every normal is within {report.angle:.3g}° of that of a sample"
        if report.coverage is not None:
            line += f"; every point is within {report.coverage:.3g} of a sample"
        if report.invisible_share is not None and not self._filling():
            share = 100.0 * report.invisible_share
            line += f"; {share:.2f} % of the surface is developable (K = 0)"
        return line + self._infinite()

    def offset(self, distance: float) -> Samples:
        """Return the samples moved along their normals: the offset surface x + d n.

        For d < 0 it lies inwards, if normals point outwards. Points, support and curvatures are
        those of the offset, as far as they are there; normals, parameters and indices stay, and
        `spline` is None. The distance is in the surface's unit L.

        Normals stay even where the offset folds, because d passes a radius of curvature of that
        side: a GaussmapWarning says at how many samples it does (if their curvatures are there),
        and the smallest radius. Where a radius becomes 0, the offset is singular: K is infinite
        with its old sign, or NaN if it was 0, and H is NaN.

        Raises InputError unless the distance is a finite number, and for curvatures whose squares
        their type does not hold (of surfaces smaller than 1e-154 or larger than 1e154);
        MissingFieldError if points lack their normals, or one of the curvatures the other one.
        """
        from .offset import offset

        return offset(self, distance)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the samples to a file; its suffix, in any case, chooses the format.

        An existing file is replaced once the new one is complete; if anything fails, it stays as it
        was. Files hold the fields that the samples hold, float32 as float32.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file. The suffix is one of

            - `.npz`: everything, the report included; reads back bit for bit.
            - `.ply`: binary, one vertex a sample, all columns and the report (in comments); reads
              back bit for bit. Indices are 32-bit. Needs the field `points`.
            - `.csv`: a header row and one row a sample; 17 significant digits (9 of float32), so
              that floats survive.
            - `.xyz`: rows `x y z nx ny nz`, digits as in `.csv`, no header. Needs `points` and
              `normals`.
            - `.vtp`: VTK PolyData with all arrays, and the report as field data; needs `points`.

        Raises
        ------
        UnknownNameError
            If the suffix is none of these.
        FileError
            If the file cannot be written.
        InputError
            If an index does not fit into a `.ply` file, or the format needs a field that is not
            there.

        """
        from .files.formats import write_samples

        write_samples(self, path)

    def mesh(self, spline: Spline | None = None, *, angle: float | None = None) -> Mesh:
        """Return a triangle mesh of the whole surface through the samples.

        Neighbours are found in (u, v): the mesh closes where the surface does, has one vertex at a
        pole, and reaches open borders by points that are added there, as far apart as samples near
        them. Then edges are flipped as long as that brings the triangles nearer to the normals: the
        largest angle between two triangles and the normals at their corners falls. Samples at one
        place become one vertex.

        `spline` is that of the samples, for samples that do not know theirs. With `angle` (degrees)
        triangles that deviate from a normal at a corner by more are left out, for samples of a part
        of the surface only. Needs the fields points, normals and uv, else MissingFieldError. Raises
        InputError if there are no samples or no spline, if a sample lies outside its domain, if
        `angle` leaves no triangle, and, without it, if there are too few samples for a mesh that
        closes.
        """
        from .meshes.meshing import mesh_of

        return mesh_of(self, self._spline_or(spline), angle)

    def coverage(self, spline: Spline | None = None, *, threads: int | None = None) -> float:
        """Return how far a point of the surface can be from the nearest sample, in L.

        It is a bound, at most 10 % above the distance of a point that was found. `spline` is that
        of the samples, for samples that do not know theirs; `threads` as in `gm.sample`, None for
        all cores. Infinite if there are no samples. Needs the field points, else MissingFieldError.
        Raises InputError if there is no spline.
        """
        from .density.coverage import coverage_of

        return coverage_of(self.points, self._spline_or(spline), threads)

    def weights(self, *, angle: float | None = None) -> NDArray[np.float64]:
        """Return how much of the area of the surface belongs to each sample: (N,), in L².

        Σ w f(points) approximates the integral of f over the surface: its area for f = 1, the
        volume of a closed surface for f = support / 3, 2π times the Euler characteristic for f =
        gaussian_curvature. The error falls with the square of the distance between samples, that is
        as 1 / N; that of the area as 1 / N², down to that of the spline. Samples at one place share
        a weight: all but one of them have 0.

        They are taken from the mesh of the samples, bent by the normals. The arguments, what fields
        are needed and what is raised are those of `mesh`; SurfaceError also if float64 does not
        hold the areas, of surfaces larger than about 1e150 or smaller than 1e-150.
        """
        from .meshes.weights import area_weights

        return area_weights(self, angle)

    def to_dataframe(self) -> pandas.DataFrame:
        """Return a table with a row for each sample and the columns of a `.csv` file.

        As the other conversions, it copies. MissingExtraError without the extra `pandas`.
        """
        from .interop import samples_to_dataframe

        return samples_to_dataframe(self)

    def to_pyvista(self) -> pyvista.PolyData:
        """Return points with all other fields as point data, normals as such.

        Needs the field points. MissingExtraError without the extra `vtk`.
        """
        from .interop import samples_to_pyvista

        return samples_to_pyvista(self)

    def to_trimesh(self) -> trimesh.PointCloud:
        """Return points in float64, with all other fields in `metadata`.

        Needs the field points. MissingExtraError without the extra `trimesh`.
        """
        from .interop import samples_to_trimesh

        return samples_to_trimesh(self)

    def to_open3d(self) -> open3d.geometry.PointCloud:
        """Return points in float64, with their normals if there are any.

        Needs the field points. MissingExtraError without the extra `open3d`.
        """
        from .interop import samples_to_open3d

        return samples_to_open3d(self)

    def __len__(self) -> int:
        return len(next(iter(self.arrays().values())))

    def __getitem__(self, key: ArrayLike | slice) -> Samples:
        rows = key if isinstance(key, slice) else rows_of(key, len(self))
        arrays = {name: array[rows] for name, array in self.arrays().items()}
        return Samples(**arrays, report=self.report, spline=self.spline)

    def __repr__(self) -> str:
        label = short_label(self.report.surface)
        return f"Samples({len(self):,} points on {label}{self._split()})"

    def _spline_or(self, spline: Spline | None) -> Spline:
        """Return the spline that is given, else that of the samples; InputError without one."""
        spline = self.spline if spline is None else spline
        if spline is None:
            raise InputError(
                "these samples do not know the spline that was sampled (those from a file do not); "
                "give it, as in samples.mesh(gm.fit(surface))."
            )
        if not isinstance(spline, Spline):
            raise InputError(f"spline must be a Spline, not {type(spline).__name__}.")
        return spline

    def _filling(self) -> int:
        """Return how many samples fill gaps, as far as that is known."""
        return int((self.normal_index < 0).sum()) if "normal_index" in self.fields else 0

    def _origin(self) -> str:
        """Say how many samples have prescribed normals, and how many fill gaps."""
        normals, filling = self.report.normals, self._filling()
        if filling == len(self) > 0:
            return " filling gaps" if normals else ""
        if normals is None:
            return ""
        given = f"{normals:,} prescribed normals"
        if not filling:
            return f" at {given}" if "normal_index" in self.fields else f", {given}"
        return f": {len(self) - filling:,} at {given}, {filling:,} filling gaps"

    def _infinite(self) -> str:
        """Say at how many samples K is infinite, and why."""
        if not count_infinite(self.arrays()):
            return ""
        infinite = np.isinf(self.gaussian_curvature)
        reason = "the spline is singular"
        if "mean_curvature" in self.fields and have_large_squares(self.mean_curvature, self.dtype):
            reason = f"it is too large for {self.dtype}"
        return f"; K is infinite at {int(infinite.sum()):,} samples, where {reason}"

    def _split(self) -> str:
        if "gaussian_curvature" not in self.fields:
            return f" ({', '.join(self.fields)} only)"
        hyperbolic = int(np.count_nonzero(self.hyperbolic))
        return f": {len(self) - hyperbolic:,} elliptic, {hyperbolic:,} hyperbolic"


def count_infinite(arrays: Mapping[str, NDArray[Any]]) -> int | None:
    """Return at how many samples K is infinite; None if K is not among their fields."""
    if "gaussian_curvature" not in arrays:
        return None
    return int(np.isinf(arrays["gaussian_curvature"]).sum())


def have_large_squares(H: NDArray[np.floating], dtype: np.dtype[Any]) -> bool:
    """Say whether the curvatures H, where they are finite, have squares that a type cannot hold."""
    finite = np.abs(H[np.isfinite(H)].astype(np.float64))
    return float(finite.max(initial=0.0)) > math.sqrt(float(np.finfo(dtype).max))


def _rebuilt(
    arrays: dict[str, NDArray[Any]], report: SamplingReport, spline: Spline | None
) -> Samples:
    """Return samples that were copied or pickled."""
    return Samples(**arrays, report=report, spline=spline)


def _common_dtype(arrays: Mapping[str, object]) -> np.dtype[np.floating]:
    """Return float32 if all that may be float32 is, otherwise float64."""
    types = {getattr(arrays[name], "dtype", None) for name in FLOAT_NAMES if name in arrays}
    return np.dtype(np.float32 if types == {np.dtype(np.float32)} else np.float64)


def _common_report(
    reports: Sequence[SamplingReport], arrays: Mapping[str, NDArray[Any]]
) -> SamplingReport:
    """Return what reports agree about, with the number of all samples."""
    common: dict[str, Any] = {
        x.name: getattr(reports[0], x.name)
        if len({getattr(report, x.name) for report in reports}) == 1
        else None
        for x in dataclass_fields(SamplingReport)
    }
    common["surface"] = common["surface"] or "several surfaces"
    common["samples"] = len(next(iter(arrays.values())))
    common["infinite_curvatures"] = count_infinite(arrays)
    return SamplingReport(**common)


def _count(name: str, value: SupportsIndex) -> int:
    """Return `value` as a plain int ≥ 0: a NumPy integer would not go into JSON."""
    try:
        count = operator.index(value)
    except TypeError:
        raise InputError(f"{name} must be an integer, not {shown(value)}.") from None
    if count < 0:
        raise InputError(f"{name} must not be negative, and is {count}.")
    return count


def _distance(name: str, value: float) -> float:
    """Return `value` as a plain float ≥ 0."""
    try:
        distance = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be a number, not {shown(value)}.") from None
    if not distance >= 0.0:
        raise InputError(f"{name} must not be negative, and is {distance!r}.")
    return distance


def _share(value: float) -> float:
    try:
        share = float(value)
    except (TypeError, ValueError):
        raise InputError(f"invisible_share must be a number, not {shown(value)}.") from None
    if not math.isfinite(share) or not -_SHARE_ROUNDING <= share <= 1.0 + _SHARE_ROUNDING:
        raise InputError(f"invisible_share must lie between 0 and 1, and is {share!r}.")
    return min(max(share, 0.0), 1.0)


def rows_of(key: ArrayLike, count: int) -> NDArray[Any]:
    """Return a mask (count,) or an array of valid row numbers, (M,)."""
    try:
        rows = np.asarray(key)
    except (TypeError, ValueError, RecursionError):  # of ragged lists
        rows = np.empty(())
    if rows.shape == (0,) and rows.dtype.kind == "f":
        rows = rows.astype(np.intp)  # NumPy takes an empty list for floats
    if rows.ndim != 1 or rows.dtype.kind not in "biu":
        raise InputError("samples are picked by a slice, a boolean mask or a 1-D index array.")
    if rows.dtype.kind == "b" and len(rows) != count:
        raise InputError(f"the mask has {len(rows)} entries, but there are {count} samples.")
    if rows.dtype.kind != "b" and len(rows) and not -count <= rows.min() <= rows.max() < count:
        raise InputError(f"an index is out of range: there are {count} samples.")
    return rows
