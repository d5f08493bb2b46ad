"""What a sampling returns: points, normals, parameters, curvatures, and how it went."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .sample_arrays import SampleArrays
from .spline import Spline, short_label
from .summary import kinds_of_points, summary_of

if TYPE_CHECKING:
    import open3d  # pyright: ignore[reportMissingImports]
    import pandas
    import pyvista
    import trimesh

    from .meshes.mesh import Mesh

__all__ = ["Samples"]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Samples(SampleArrays):
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
        return summary_of(self)

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

    def __repr__(self) -> str:
        label = short_label(self.report.surface)
        return f"Samples({len(self):,} points on {label}{kinds_of_points(self)})"

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
