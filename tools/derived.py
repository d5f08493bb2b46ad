"""The methods of `Samples` that tools define; each loads its tool when it is called.

`Samples` takes them from here (see `runtime/base/later.py`), and imports nothing from tools.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, cast

import numpy as np
from numpy.typing import NDArray

from ..runtime.base.checks import known_name, listed, positive_number
from ..runtime.base.errors import InputError, shown
from ..runtime.base.progress import busy
from ..runtime.samples.samples import Samples, spline_or
from ..runtime.samples.whole import Whole
from ..runtime.surface.surface import Surface

if TYPE_CHECKING:
    import trimesh

    from ..runtime.spline.nets import AnySpline
    from .cad.part import Part
    from .gauss_map.silhouette import Silhouette
    from .meshes.mesh import Mesh

# The number of samples of the mesh that decides which points of a silhouette are hidden.
OF_VIEW = 10_000


def write(
    self: Samples,
    path: str | os.PathLike[str],
    *,
    fields: Sequence[str] | None = None,
    progress: bool = False,
) -> None:
    """Write the samples to a file; its suffix, in any case, chooses the format.

    An existing file is replaced once the new one is complete; if anything fails, it stays as it
    was. Numbers in float32 are written as float32.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file. The suffix is one of

        - `.npz`: everything, the report included; reads back bit for bit.
        - `.ply`: binary, one vertex a sample, all columns and the report (in comments); reads
          back bit for bit. Indices are 32-bit. Needs the field `points`.
        - `.csv`: a header row and one row a sample; as many digits as it takes to read the same
          numbers again. Where the unit of length is known, of parts and of terrain with a reference
          system, columns of lengths and curvatures name it: `x [mm]`. Samples of a CAD part that
          have `face_index` and know their part also have the columns `source_index`, `face_name`,
          `face_kind` and `face_radius` of the face, and samples of terrain `slope` and `aspect`.
          With the extra "tables" Polars writes the file, ten times as fast.
        - `.xyz`: rows `x y z nx ny nz`, digits as in `.csv`, no header. Needs `points` and
          `normals`.
        - `.vtp`: VTK PolyData with all arrays, and the report as field data; needs `points`, and
          the extra `vtk`.
        - `.parquet`: the columns of `.csv` in binary, and the report and the units in the
          metadata of the schema; needs the extra "tables" (PyArrow).
        - `.las`, `.laz`: points, with all other columns as extra dimensions, and the CRS of a
          `terrain`, whose `origin` is added again; coordinates are rounded to 1e-8 of the
          extent. Need `points`, and the extra "gis" (laspy).
        - `.gpkg`, `.geojson`: points with all other columns, `slope` and `aspect`, and the CRS, for
          programs of GIS. They need the extra "gis" (pyogrio).
    fields : sequence of str, optional
        The fields to write, such as ``("points", "normals")``; by default all fields of the
        samples.
    progress : bool, default False
        Show the progress on a terminal, after the first second.

    Raises
    ------
    UnknownNameError
        If the suffix is none of these, or the samples do not hold a field.
    FileError
        If the file cannot be written.
    InputError
        If an index does not fit into a `.ply` file, or the format needs a missing field.
    MissingExtraError
        If a library that the format needs is not installed.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> samples.write("torus.ply")
    >>> len(gm.read_samples("torus.ply"))
    200
    >>> samples.write("points.npz", fields=("points",))
    >>> gm.read_samples("points.npz").fields
    ('points',)

    """
    from .files.formats import write_samples

    with busy("writing", progress):
        write_samples(self if fields is None else _only(self, fields), path)


def _only(samples: Samples, fields: Sequence[str]) -> Samples:
    """Return samples with some of their fields."""
    names, held = listed(fields), samples.arrays()
    if names is None:
        raise InputError(f"fields must be a tuple of names, not {shown(fields)}.")
    arrays = {x: held[known_name(x, samples.fields, "field of these samples")] for x in names}
    known = {x: getattr(samples, x) for x in ("report", "spline", "surface", "offset_of")}
    return Samples(**arrays, **known)


def mesh(
    self: Samples,
    spline: AnySpline | None = None,
    *,
    angle: float | None = None,
    prefer: Literal["shape", "normals"] = "shape",
    progress: bool = False,
) -> Mesh:
    """Return a triangle mesh of the whole surface through the samples.

    A Delaunay triangulation of the parameters connects the samples, and then edges are flipped. The
    mesh closes where the surface does, has one vertex at a pole, and reaches open boundaries by
    added points, spaced like the samples near them. Samples at the same point become one vertex.

    Samples on a graded grid (`row` and `column`) stay vertices, however long its cells are.

    An `offset` has a mesh unless it folds, is trimmed, or belongs to a CAD part or a one-sided
    surface. A fold is detected by edges that turn around and by the curvatures of the samples, if
    they have these. A fold between samples is not detected.

    For a CAD part the result is a `PartMesh` of new vertices, as many as there are samples: first
    the vertices and edges of the part are sampled, once for both adjacent faces, then the interior
    of faces, with the density of the samples. Adjacent faces share vertices, so that the mesh of a
    closed part is closed. Needs the extra `mesh`.

    Parameters
    ----------
    spline : Spline, optional
        The spline of the samples, if they do not hold it; for an offset, the spline of `offset_of`.
    angle : float, optional
        In degrees. Triangles whose normals deviate by more from a normal at one of their corners
        are left out; use this for samples of only a part of the surface. Not for CAD parts.
    prefer : {"shape", "normals"}, default "shape"
        - "shape": triangles are Delaunay on the surface, and have angles as large as the samples
          allow. A sample is left out if it is so close to others that the smallest angle of a
          triangle stays below 5°. Then further samples are left out, at most a tenth of the
          remaining ones, until the smallest angles of 95 % of the triangles are at least 25°.
          `Mesh.left_out` includes all these samples. They lie where distances change by a factor of
          two from one sample to the next, since triangles there cannot have large angles. With a
          count and ``density="balanced"`` on a closed surface, most narrow bends cost no samples,
          and very sharp ones up to 8 % of the count. Samples on a grid are never left out, even if
          its cells are long.
        - "normals": triangles deviate from the normals at their corners as little as the
          samples allow. They are long and thin where the surface is curved in one direction only. A
          sample is left out where a triangle would have no area. On a CAD part, planes, cylinders
          and cones have vertices on their edges only; on other faces the angles between normals
          of neighbouring vertices are about equal.
    progress : bool, default False
        Show the progress on a terminal, after the first second.

    Returns
    -------
    Mesh
        The vertices, normals, parameters and triangles.

    Raises
    ------
    MissingFieldError
        Unless the samples have the fields points, normals and uv; those on a grid (`density` of
        the report) need row and column, too.
    InputError
        Without samples or spline, for an offset without a mesh, if a sample lies outside the domain
        of the spline, if `angle` leaves no triangle, and, without `angle`, if there are too few
        samples for a mesh that closes. For a CAD part, if there are fewer samples than its edges
        need, its file has no loops of edges, or, for "shape", the density is neither "balanced" nor
        "uniform".
    SurfaceError
        If no face of a CAD part can be meshed.
    MissingExtraError
        For a CAD part, without the extra `mesh`.

    Warns
    -----
    GaussmapWarning
        If faces of a CAD part are missing, see `PartMesh.failed`, or if triangles of a CAD part
        point inward, and no larger count is known that avoids this.

    Notes
    -----
    Well-shaped triangles are the default because most programs that read a mesh need them:
    simulation, smoothing, simplification, discrete curvatures, and files of single precision,
    in which thin triangles lose their area. They cost accuracy: with the same number of
    vertices, distances and angles to the surface are larger by about a third than with
    "normals", see docs/guides/meshes.md. So "normals" is the better choice for rendering, and for
    areas, volumes and other integrals: `weights` uses it.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> samples.mesh()
    Mesh(200 vertices, 400 triangles on torus)
    >>> accurate = samples.mesh(prefer="normals")
    >>> bool(accurate.angles.mean() < samples.mesh().angles.mean())
    True

    """
    if not len(self):
        raise InputError("there are no samples, and so there is nothing to make a mesh of.")
    if isinstance(self.surface, Whole):
        from .cad.part_meshing import mesh_of_samples

        with busy("meshing", progress):
            return mesh_of_samples(self, angle, prefer)
    from .meshes.meshing import mesh_of

    if self.offset_of is not None and isinstance(self.offset_of.surface, Whole):
        raise InputError("an offset of a CAD part has no mesh.")
    with busy("meshing", progress):
        return mesh_of(self, spline_or(self, spline, self.offset_of), angle, prefer)


def weights(
    self: Samples, *, angle: float | None = None, progress: bool = False
) -> NDArray[np.float64]:
    """Return the area of the surface that each sample stands for.

    Σ w f(points) approximates the integral of f over the surface: its area for f = 1, the volume of
    a closed surface for f = support / 3, 2π times the Euler characteristic for f =
    gaussian_curvature. The error falls with the square of the distance between samples, that is as
    1 / N. For the area it falls as 1 / N², down to the error of the spline (1,000 samples of a
    NURBS ellipsoid: 2e-5), but as 1 / N if a boundary is curved (a disc: 4e-4). The weights come
    from the mesh of the samples, whose triangles are curved according to the normals, and whose
    boundary is a polygon.

    Parameters
    ----------
    angle : float, optional
        In degrees, as in `mesh`.
    progress : bool, default False
        Show the progress on a terminal, after the first second.

    Returns
    -------
    (N,) float64 array
        Areas in L². Of samples that coincide, one has the whole area, and the others have 0.

    Raises
    ------
    MissingFieldError, InputError
        As `mesh`.
    SurfaceError
        If the areas are out of the range of float64, for surfaces larger than about 1e150 or
        smaller than 1e-150.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 500)
    >>> f"{samples.weights().sum():.1f}"  # 4π² · 0.35
    '13.8'

    """
    from .meshes.weights import area_weights

    with busy("computing weights", progress):
        if isinstance(self.surface, Whole):
            from .cad.reached import weights_of

            return weights_of(cast("Part", self.surface), self)
        return area_weights(self, angle)


def offset(self: Samples, distance: float, *, trimmed: bool = False) -> Samples:
    """Return the samples moved along their normals: the offset surface x + d n.

    Points, support and curvatures become those of the offset, if the samples have them; normals,
    parameters and indices stay. `spline` and `surface` are None; `offset_of` has the original ones,
    from which `mesh` and `weights` of the offset determine neighbours.

    Parameters
    ----------
    distance : float
        The distance d, in L. For d < 0 the offset lies inwards, if normals point outwards.
    trimmed : bool, default False
        Leave out samples whose points become nearer to the surface than the distance: parts that
        fold, and parts that come near to other parts of the surface. At the samples that stay, a
        ball of this radius touches the surface and does not cut it. After several offsets, the
        total distance counts. Distances are measured from at least 20,000 samples of the surface
        (of the selected faces, if a part is a selection), whose gaps are at most about a fifth of
        the distance. So all samples that are left out are nearer than the distance, and samples
        that stay may be nearer by 2 %, where sheets meet.

    Returns
    -------
    Samples
        One for each sample, without those that are trimmed. Where a radius of curvature becomes 0,
        the offset is singular: K is infinite with its old sign, or NaN if it was 0, and H is NaN.

    Raises
    ------
    InputError
        Unless the distance is a finite number, and if squares of curvatures are out of the range of
        their type (for surfaces smaller than 1e-154 or larger than 1e154). If `trimmed`, also for
        samples that do not hold their surface, and if the distance is less than 1/180 of its size.
    MissingFieldError
        If points lack their normals, or one curvature lacks the other.

    Warns
    -----
    GaussmapWarning
        If the offset folds, because d passes a radius of curvature on that side. The warning gives
        the number of samples at which it folds (if they have curvatures), and the smallest radius
        on that side. Normals do not change where the offset folds.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("sphere", normals=[[1, 0, 0]]).offset(0.5).points.round(3) + 0.0
    array([[1.5, 0. , 0. ]])

    A ball of radius 0.7 does not fit into the hole of a torus, whose radius is 0.65:

    >>> samples = gm.sample("torus", normals=[[1, 0, 0]])
    >>> samples.offset(0.7, trimmed=True).points.round(2) + 0.0
    array([[2.05, 0.  , 0.  ]])

    """
    from .support.offset import offset as moved_along_normals

    return moved_along_normals(self, distance, trimmed)


def unobstructed(
    self: Samples,
    distance: float,
    *,
    by: Part | Surface | Mesh | trimesh.Trimesh | None = None,
) -> NDArray[np.bool_]:
    """Return which samples a probe can reach from a distance, along their normals.

    The segment from the sample to the point x + d n of `offset` must not enter the part, or another
    obstacle. A probe has a width: for a ball of radius r, take the samples ``offset(r)``, which are
    centres of the ball. Segments are tested against a mesh of the obstacle; the result may be wrong
    for a segment that passes the obstacle at less than the distance between mesh and obstacle.

    Parameters
    ----------
    distance : float
        The distance d, in L; infinity for the whole ray.
    by : Part, Surface, Mesh or trimesh.Trimesh, optional
        The obstacle: by default the part or surface of the samples. A part or surface becomes a
        mesh of 20,000 vertices, as ``gm.sample(part, 20_000).mesh()``, or of more if it has very
        many edges; the mesh is made once, and stored with the part. For faces selected by
        `Part.select`, the obstacle is the whole part, unless the selection was read from a file.
        For a clamp or a table, give its mesh.

    Returns
    -------
    (N,) bool array
        Whether the segment is free.

    Raises
    ------
    InputError
        Unless the distance is positive, and the mesh closed with outward normals; for an object
        that cannot be an obstacle; and as `mesh`.
    MissingFieldError
        Unless the samples have the fields points and normals.
    MissingExtraError
        For a part, without the extra `mesh`.

    See Also
    --------
    offset : the points at the other ends of the segments.
    Reach : with `clearance`, samples only where the segment is free.

    Examples
    --------
    In the hole of a torus, whose radius is 0.65, a segment longer than 1.3 meets the other side:

    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", normals=[[1, 0, 0]])
    >>> samples.points.round(2) + 0.0
    array([[ 1.35,  0.  ,  0.  ],
           [-0.65,  0.  ,  0.  ]])
    >>> samples.unobstructed(1.2), samples.unobstructed(1.4)
    (array([ True,  True]), array([ True, False]))

    """
    from .meshes.rays import obstacle_from

    far = positive_number(distance, "distance", infinite=True)
    if by is None:
        base = self if self.offset_of is None else self.offset_of
        by = cast("Part | Surface | None", base.surface) or self.mesh()
    if isinstance(by, Whole | Surface):
        from .cad.obstacle import obstacle_of

        obstacle = obstacle_of(cast("Part | Surface", by))
    else:
        obstacle = obstacle_from(by)
    if not obstacle.closed:
        raise InputError(
            "rays need a closed obstacle, whose triangles say which side is outside, and this one "
            "is open; give the whole part, or a closed mesh, as in unobstructed(5.0, by=part)."
        )
    points, normals = (x.astype(np.float64) for x in (self.points, self.normals))
    return obstacle.are_free(points, normals, far)


def visible(self: Silhouette, *, by: Mesh | None = None) -> NDArray[np.bool_]:
    """Return a mask of the visible points of a silhouette: no part of the surface hides them.

    For a silhouette along a direction, the eye is infinitely far away and looks in this direction.

    Parameters
    ----------
    by : Mesh, optional
        A mesh of the surface, against which rays are tested. By default a mesh of 10,000 samples is
        made, which takes most of the time: for many views, make one mesh and pass it.
        The result may be wrong next to cusps and junctions of the outline, where a ray passes the
        surface at less than about the distance between mesh and surface.

    Returns
    -------
    (N,) bool array
        Whether a point is seen.

    Raises
    ------
    InputError
        For an object that is not a mesh, and as `mesh`.
    MissingFieldError
        Unless the samples have the fields points, normals and uv.

    See Also
    --------
    unobstructed : the same along normals.

    Examples
    --------
    The contour of a torus has two curves; the torus hides a part of the inner one:

    >>> import gaussmap as gm
    >>> outline = gm.silhouette("torus", viewpoint=(4, 0, 2), count=200)
    >>> seen = outline.visible(by=gm.sample("torus", 2_000).mesh())
    >>> bool(seen[outline.elliptic].all()), 0.2 < float(seen[outline.hyperbolic].mean()) < 0.9
    (True, True)

    """
    from .gauss_map.silhouette import bends
    from .meshes.mesh import Mesh
    from .meshes.rays import visible as are_seen
    from .sampling.sample import sample

    points, normals = (x.astype(np.float64) for x in (self.points, self.normals))
    if not len(points):
        return np.zeros(0, np.bool_)
    if by is None:
        given = self.surface if self.report.on == "surface" else self.spline
        by = sample(cast("Surface", given), OF_VIEW).mesh()
    if not isinstance(by, Mesh):
        raise InputError(f"by must be a Mesh, not {type(by).__name__}.")
    assert self.eye is not None
    size = np.ptp(by.vertices, axis=0).sum()
    to_eye = -self.eye.rays(points) * (2.0 * size if self.eye.far else 1.0)
    return are_seen(points, normals, to_eye, bends(self), by)
