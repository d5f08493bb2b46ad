"""The formats of files, with their writers and readers; suffixes of files choose formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from io import BufferedReader
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ...runtime.base.errors import InputError, UnknownNameError
from ...runtime.base.extras import check_extra
from ...runtime.base.georeference import warn_of_rounding
from ...runtime.samples.samples import Samples
from .las import write_las
from .npz import read_npz, write_npz
from .of_terrain import write_points
from .parquet import write_parquet
from .paths import (
    PathLike,
    atomic_path,
    check_target,
    checked_path,
    known_suffix,
    written_by_library,
)  # fmt: skip
from .ply import read_ply, write_mesh_ply, write_ply
from .reading import opened
from .tables import write_csv, write_xyz
from .threemf import write_3mf
from .triangle_files import write_glb, write_obj, write_stl
from .vtk import write_mesh_vtp, write_vtp, write_vtu

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh


class Format(NamedTuple):
    """The writer of a format, the fields that it needs, the library that it uses, and its extra."""

    write: Callable[[Any, Path], None]
    needs: tuple[str, ...] = ()
    library: str = ""
    extra: str = ""


READERS: dict[str, Callable[[BufferedReader], Samples]] = {".npz": read_npz, ".ply": read_ply}
OF_SAMPLES = {
    ".npz": Format(write_npz),
    ".ply": Format(write_ply, ("points",)),
    ".csv": Format(write_csv),
    ".vtp": Format(write_vtp, ("points",), "pyvista", "vtk"),
    ".xyz": Format(write_xyz, ("points", "normals")),
    ".parquet": Format(write_parquet, (), "pyarrow", "tables"),
    ".gpkg": Format(write_points, ("points",), "pyogrio", "gis"),
    ".geojson": Format(write_points, ("points",), "pyogrio", "gis"),
    ".las": Format(write_las, ("points",), "laspy", "gis"),
    ".laz": Format(write_las, ("points",), "lazrs", "gis"),
}
OF_MESHES = {
    ".ply": Format(write_mesh_ply),
    ".obj": Format(write_obj),
    ".stl": Format(write_stl),
    ".3mf": Format(write_3mf),
    ".vtu": Format(write_vtu, (), "pyvista", "vtk"),
    ".vtp": Format(write_mesh_vtp, (), "pyvista", "vtk"),
    ".glb": Format(write_glb, (), "trimesh", "trimesh"),
}
SUFFIXES, READABLE_SUFFIXES, MESH_SUFFIXES = tuple(OF_SAMPLES), tuple(READERS), tuple(OF_MESHES)
SINGLE = (".glb", ".stl")  # of single precision


def write_samples(samples: Samples, path: PathLike) -> None:
    """Write samples to a file; see `Samples.write`."""
    suffix = _suffix_of_samples(path)
    check_fields(path, samples.fields)
    _check_library(suffix, OF_SAMPLES)
    with atomic_path(path) as temporary, written_by_library(path):
        OF_SAMPLES[suffix].write(samples, temporary)


def write_mesh(mesh: Mesh, path: PathLike) -> None:
    """Write a mesh to a file; see `Mesh.write`."""
    suffix = known_suffix(path, MESH_SUFFIXES)
    _check_library(suffix, OF_MESHES)
    if not len(mesh.triangles):
        raise InputError("this mesh has no triangles, and so there is nothing to write.")
    if suffix in SINGLE:
        warn_of_rounding(mesh.vertices, 4)
    with atomic_path(path) as temporary, written_by_library(path):
        OF_MESHES[suffix].write(mesh, temporary)


def check_samples_target(path: PathLike) -> None:
    """Raise now the errors that writing samples to `path` would raise later, see `check_target`."""
    suffix = _suffix_of_samples(path)
    _check_target(path, suffix, OF_SAMPLES)


def check_mesh_target(path: PathLike) -> None:
    """Raise now the errors that writing a mesh to `path` would raise later, see `check_target`."""
    _check_target(path, known_suffix(path, MESH_SUFFIXES), OF_MESHES)


def _check_target(path: PathLike, suffix: str, formats: Mapping[str, Format]) -> None:
    check_target(path, tuple(formats))
    _check_library(suffix, formats)


def _check_library(suffix: str, formats: Mapping[str, Format]) -> None:
    """Raise MissingExtraError if the library that a format needs is missing."""
    if library := formats[suffix].library:
        check_extra(library, formats[suffix].extra, purpose=f"a {suffix} file")


def _suffix_of_samples(path: PathLike) -> str:
    """Return the suffix; UnknownNameError if it is unknown, with a hint if it is for meshes."""
    suffix = checked_path(path).suffix.lower()
    if suffix in MESH_SUFFIXES and suffix not in SUFFIXES:
        raise UnknownNameError(
            f"'{path}' has the suffix '{suffix}' of meshes; use one of {', '.join(SUFFIXES)} for "
            "samples, or write a mesh, by the command `gaussmap mesh` or the method `mesh`."
        )
    return known_suffix(path, SUFFIXES)


def check_fields(path: PathLike, fields: Sequence[str]) -> None:
    """Raise InputError if the format of the suffix needs fields that are not among `fields`."""
    suffix = _suffix_of_samples(path)
    lacking = [repr(name) for name in OF_SAMPLES[suffix].needs if name not in fields]
    if lacking:
        raise InputError(
            f"a {suffix} file needs {' and '.join(lacking)}; add that to the fields, or write a "
            ".npz or .csv file."
        )


def read_samples(path: PathLike) -> Samples:
    """Read samples from a `.npz` or `.ply` file that `write_samples` wrote.

    A `.ply` file that another program rewrote can be read if it is binary and has all the columns.
    If the comments that hold the report are lost, the report's numbers are None, except the number
    of samples. A file with only some of the fields lists them in a comment, which must not be lost.
    Nothing in the file is unpickled.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file.

    Returns
    -------
    Samples
        The samples and their report, without the spline.

    Raises
    ------
    UnknownNameError
        If the suffix is neither `.npz` nor `.ply`.
    FileError
        If the file is missing, unreadable, damaged, or not from gaussmap.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("torus", 500).write("torus.npz")
    >>> len(gm.read_samples("torus.npz"))
    500

    """
    path = checked_path(path)
    suffix = known_suffix(path, READABLE_SUFFIXES)
    with opened(path, f"{suffix} file of gaussmap", "samples") as file:
        return READERS[suffix](file)
