"""`Samples`, the result of a sampling: points, normals, parameters, curvatures, and a report."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.errors import InputError
from ..base.wording import plural
from ..fitting.fit import fit
from ..spline.nets import AnySpline, on_grid
from ..spline.spline import Spline, short_label
from ..surface.surface import Surface
from .arrays import SampleArrays
from .offset_of import OffsetOf
from .samples_methods import Methods
from .summary import kinds_of_points, summary_of
from .whole import Whole


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Samples(SampleArrays, Methods):
    """N samples of a surface, one row each; lengths in the unit L of the surface.

    `sample` and the other samplers make them. A boolean mask (N,), an index array, a slice or a
    number picks rows, with the same report and spline: ``samples[samples.elliptic]``. The result is
    always Samples; ``samples[0]`` and the items of a loop have length 1. `Samples.concatenate`
    joins several. ``numpy.asarray(samples)`` is their points.

    With ``dtype=numpy.float32``, all numbers except the indices are float32. Fields that were not
    requested (`fields` of `sample`) are missing: reading them raises MissingFieldError, an
    AttributeError. All arrays are C-contiguous; given arrays that are not are copied.

    With ``on="surface"`` (see `sample`), points, normals and curvatures are those of the surface at
    `uv`. A sample with a `normal_index` has the prescribed normal; the normal of the surface at its
    `uv` differs from it by rounding, 1e-12 at regular points. With ``on="spline"``, and where
    `on_surface` is False, points, normals and curvatures are those of the spline.

    Attributes
    ----------
    points : (N, 3) float64 array
        Points of the surface, in L.
    normals : (N, 3) float64 array
        Unit normals at the points.
    uv : (N, 2) float64 array
        Parameters of the points.
    support : (N,) float64 array
        Support function h = n·x (4), in L.
    gaussian_curvature : (N,) float64 array
        Gaussian curvature K, in 1/L². Points are hyperbolic if its sign bit is set, −0.0 included,
        and also `parabolic` if it is zero up to rounding. On surfaces smaller than 1e-154 it may
        overflow to infinity, and on surfaces larger than 1e154 underflow to zero.
    mean_curvature : (N,) float64 array
        Mean curvature H, in 1/L, positive for a sphere with outward normals.
    normal_index : (N,) int64 array
        Rows of the prescribed normals; −1 for a sample that fills a gap.
    patch_index : (N,) int64 array or None
        Indices of the patches of the spline in which the samples were found. None on CAD parts, and
        at prescribed normals whose points are proved to be complete: no spline is used for these.
    on_surface : (N,) bool array or None
        Whether the sample is on the surface, with the normal of the surface up to 1e-9. False at
        singular points, and for a sample of a silhouette that could not be moved from the spline to
        the surface. The normal, K and H of such a sample are those of the spline; the surface at
        its `uv` may have an entirely different normal, K and H, even another sign of K. None with
        ``on="spline"``, or if it was not requested.
    uv_radius : (N, 2) float64 array or None
        At prescribed normals whose points are proved to be complete: bounds of the errors of `uv`;
        for a `component` that is not regular, bounds of the differences between `uv` and the
        parameters of all points of the component. NaN on faces of parts where points are estimated.
        None for other samples.
    component : (N,) uint8 array or None
        For samples at prescribed normals: the kind of the component of points with this normal that
        a sample represents, see `Component`. None for other samples, which are regular. Samples
        that are not regular have K = 0, and are not vertices of meshes; their `weights` are 0.
    row, column : (N,) int64 array or None
        For samples on a grid (see ``density="aligned"`` of `sample`): the indices, from 0 on, of
        the lines v = const and u = const that meet at a sample; −1 for a sample that is not on a
        grid. None if no sample is on a grid, or if they were not requested.
    report : SamplingReport
        A report on the sampling.
    spline : Spline, NetSpline or None
        The spline that was sampled; None if it is unknown, as for samples from a file, for proved
        points of a `GaussMap`, which needs none, and for samples of several pieces (see
        `Surface.pieces`), each of which has one.
    face_index, solid_index : (N,) int64 array or None
        For a CAD part: the indices of the sample's face and solid in `Part.faces` and
        `Part.solids`; −1 for a face that belongs to no solid. `uv` are those of the surface of the
        face. None for other samples.
    other_normals : (N, 3) float64 array or None
        With ``edges=True``: unit normals of the second face of a sample on a sharp edge; NaN for
        other samples. On an edge `normals`, `uv`, curvatures and `face_index` are those of the
        first face.
    other_uv : (N, 2) float64 array or None
        With ``edges=True``: parameters on the second face of a sharp edge; NaN for other samples.
    other_face_index : (N,) int64 array or None
        With ``edges=True``: the second face of a sample on a sharp edge; −1 for other samples.
    surface : Surface, Part or None
        The surface, or the CAD part, on which the samples are; None with ``on="spline"``, for
        samples from a file, and after pickling if the surface cannot be pickled.
    offset_of : OffsetOf or None
        For samples of an `offset`: its distance, and the spline and the surface of the samples that
        were moved.

    Raises
    ------
    InputError
        If an array has another shape or dtype, or if there is no array.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> samples
    Samples(200 points on torus: 116 with K > 0, 84 with K < 0)
    >>> samples[samples.elliptic][:10]
    Samples(10 points on torus: 10 with K > 0)
    >>> samples[0], [len(one) for one in samples[:3]]
    (Samples(1 point on torus: 1 with K < 0), [1, 1, 1])
    >>> np.asarray(samples) is samples.points
    True
    >>> samples.points.shape, samples.normals.shape, samples.uv.shape
    ((200, 3), (200, 3), (200, 2))
    >>> K, H = samples.gaussian_curvature, samples.mean_curvature
    >>> bool((samples.principal_curvatures.sum(axis=1) - 2 * H).max() < 1e-12)
    True
    >>> bool((K[samples.hyperbolic] < 0).all())
    True
    >>> samples[:1].slope.shape, bool((samples.aspect < 360.0).all())
    ((1,), True)
    >>> samples.fields
    ('points', 'normals', 'uv', 'support', ..., 'patch_index', 'on_surface')
    >>> bool(abs(samples.support).max() < 1.36), bool(samples.patch_index.max() < 1024)
    (True, True)
    >>> filling = samples.normal_index == -1
    >>> bool((samples.kind[filling] == "filling").all())
    True
    >>> samples.dtype, samples.spline, samples.report.samples
    (dtype('float64'), Spline(16 × 16 cells of torus), 200)
    >>> samples.on_surface.all(), samples.surface.name
    (np.True_, 'torus')
    >>> proved = gm.sample("torus", normals=[[1, 0, 0]])
    >>> proved.uv_radius.shape, bool(proved.uv_radius.max() < 1e-12)
    ((2, 2), True)
    >>> bool((proved.component == gm.Component.REGULAR).all())
    True
    >>> on_grid = gm.sample("torus", 200, density="aligned", cells=(16, 16))
    >>> bool((on_grid.row >= -1).all()), bool((on_grid.column >= -1).all())
    (True, True)
    >>> samples.face_index is samples.solid_index is None  # not of a CAD part
    True
    >>> samples.other_normals is samples.other_uv is samples.other_face_index is None
    True
    >>> samples.offset_of, samples.offset(0.1).offset_of.distance
    (None, 0.1)

    """

    def summary(self) -> str:
        """Return one line: the number of samples, their origin, and their coverage.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("torus", normals=[[1, 0, 0], [0, 1, 1]], cells=(16, 16)).summary()
        '4 samples at 2 prescribed normals, exactly 2 each (2 with K > 0, ...); proved ...'

        """
        return summary_of(self)

    def __repr__(self) -> str:
        label = short_label(self.report.surface)
        points = plural(len(self), "point")
        return f"{type(self).__name__}({points} on {label}{kinds_of_points(self)})"


def spline_or(samples: Samples, spline: AnySpline | None, moved: OffsetOf | None = None) -> Spline:
    """Return `spline` or, if it is None, the samples' spline, or else a spline of their surface.

    For samples of an offset, spline and surface are taken from `moved`, from which the samples were
    moved. Raises InputError if there is no spline.
    """
    held = moved or samples
    spline, surface = held.spline if spline is None else spline, held.surface
    if spline is None and isinstance(surface, Surface) and len(surface.pieces()) == 1:
        spline = fit(surface)
    if spline is None and isinstance(surface, Whole):
        raise InputError(
            "this is for samples of one surface, and these are of a CAD part; sample "
            "part.faces[0].surface, for example."
        )
    if spline is None:
        raise InputError(
            "these samples do not hold the spline that was sampled (those from a file, of an "
            "offset and of several pieces do not); give it, as in "
            "samples.mesh(gm.fit(surface)), or sample each of surface.pieces()."
        )
    if not isinstance(spline, AnySpline):
        raise InputError(f"spline must be a Spline, not {type(spline).__name__}.")
    return on_grid(spline)
