"""`sample`: from a surface to its samples, in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ...runtime.base.checks import yes_or_no
from ...runtime.base.errors import InputError, in_memory
from ...runtime.base.georeference import warn_of_rounding
from ...runtime.base.memory import check_memory
from ...runtime.base.progress import busy
from ...runtime.directions.regions import Reach
from ...runtime.map import check_part, kept_map
from ...runtime.onto_surface.on_spline import OnPatches, OnSpline, on_grids
from ...runtime.onto_surface.on_surface import place_of_samples
from ...runtime.onto_surface.reach import in_reach
from ...runtime.onto_surface.smooth_pieces import geometries_of, report_of
from ...runtime.samples.fields import (
    FLAG_NAMES,
    GRID_NAMES,
    bytes_of,
    checked_dtype,
    checked_fields,
)
from ...runtime.samples.report import warn_of
from ...runtime.samples.samples import Samples
from ...runtime.samples.whole import Whole
from ...runtime.spline.nets import AnySpline, NetSpline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..density.chosen_normals import choose
from ..density.filling import fields_of, fill, target_of
from ..density.grid import lines_of, without_lines
from ..density.request import Request, checked_request
from ..density.surface_piece import SurfacePiece, space_of


def sample(
    surface: Surface | AnySpline | Whole | str,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    reach: tuple[ArrayLike, float] | Reach | None = None,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
    edges: bool = False,
) -> Samples:
    """Return points of a surface with their normals, denser where it is more curved.

    One of `count`, `normals`, `angle` and `coverage` determines the number of points.

    Parameters
    ----------
    surface : Surface, Spline, Part or str
        The surface, or its name in the catalogue (see `gaussmap.surfaces`). All faces of a part,
        read from a CAD file (see `read_part`) or made of surfaces (see `Part`), and all smooth
        pieces of a NURBS (see `Surface.pieces`), are sampled as one surface.
    count : int, optional
        The number of samples. It is met exactly; with ``density="gauss"`` within 2 % or 5 samples.
    normals : (S, 3) array_like, optional
        Directions of any length but 0, such as ``icosphere(32)``: the samples are all points with
        one of these normals, each exactly once.
    angle : float, optional
        The largest angle, in degrees and at most 90, between the normal of any point of the surface
        and that of the sample nearest in normal. Not with ``density="gauss"``.
    coverage : float, optional
        The largest distance, in the unit L of the surface, from any point of it to the nearest
        sample on its side (see Notes). It is given alone, or together with one of the other three.
    density : {"gauss", "balanced", "aligned", "uniform"} or float, optional
        The target density. "gauss", the default with `normals` alone, is |K|: samples are only at
        prescribed normals. "balanced", the default otherwise, also fills the gaps between these.
        "aligned" is a grid along parameter lines, "uniform" is constant, and a number α means
        |K|^α; see Notes. Splines of nets (`Spline.from_nets`) have "gauss" only.
    reach : (axis, angle) or Reach, optional
        Only points whose normal is within an angle, in degrees, of a direction (3,) are sampled,
        such as that of a probe, a camera or a printer. A `Reach` can also limit slopes and
        aspects, and keep samples away from edges. Count, angle and coverage refer to the points
        that remain. Not with ``density="aligned"``.
    cells : (int, int), optional
        The numbers of cells along u and v of the spline that approximates the surface, see `fit`.
    on : {"surface", "spline"}, optional
        Whether samples lie on the surface itself, or on its spline. By default they lie on the
        surface, unless it is given by points or as a spline. Splines end at the creases of NURBS:
        on them, points of creases have no samples.
    fields : sequence of str, optional
        The arrays of `Samples` that are computed and stored, such as ``("points", "normals")``; all
        by default.
    dtype : dtype_like, default numpy.float64
        With numpy.float32, real numbers are computed in float64, and rounded when they are stored.
    threads : int, optional
        The number of threads, by default one for each core. The samples do not depend on it.
    progress : bool, default False
        Show progress on a terminal, after the first second.
    edges : bool, default False
        Add samples on the sharp edges of a CAD part, where the normals of two faces differ by more
        than 1°. They come last, and are not part of the count.

    Returns
    -------
    Samples
        The samples at normals, followed by those that fill gaps, of `kind` "filling", whose
        `normal_index` is −1. Samples at normals are in the order of the normals, then of u and v
        if they are proved, else of the patches. The report has the angle and the coverage that were
        reached, if they were requested.

    Raises
    ------
    InputError
        For unusable arguments, or too little memory.
    UnknownNameError
        For an unknown surface, field or density.
    SurfaceError
        If the surface cannot be evaluated, or has no area.

    Warns
    -----
    GaussmapWarning
        If developable regions get no samples, or if `count` or `coverage` cannot be met.

    See Also
    --------
    sample_many : the samples of several surfaces.
    sample_stream : samples in chunks, in bounded memory.
    GaussMap : the points of one surface at normals, for repeated queries.
    Samples.coverage : the coverage of any samples.

    Notes
    -----
    **Densities.** "gauss" is the method of the paper (Sect. 4.2): normals are uniform on the
    sphere, so that samples have the density |K|. Developable regions get none, and next to open
    boundaries gaps between normals are up to 50 % wider.

    "balanced" has fewer normals, and samples that fill the gaps: the distance of any point from the
    nearest sample is at most r/max(κ, √λ). κ is the larger of |κ₁| and |κ₂|, so that normals of
    neighbouring samples differ by about r radians; with `angle`, r is twice the angle. λ is 0.8
    times the mean of κ², or follows from `coverage`. With a count or a coverage, κ is capped at
    20 √λ; with an angle, it is capped at 10 √λ, also in the mean of κ².

    "aligned" is for `count`, `angle` and `coverage`. The spacing of its lines u = const and v =
    const follows the rate at which the normal turns. It takes fewer samples for the same angles if
    parameter lines are lines of curvature, and more otherwise. Samples of the grid, of `kind`
    "grid", come first.

    "uniform" is for `count` or `coverage`; a number α, 0 < α ≤ 8, is for `count`. Where the
    curvature is below the error of the spline, |K|^α is replaced by a constant.

    **Angles** next to singular points of the spline, such as cusps, are bounded down to cells of
    2⁻¹⁴ of the size of the spline.

    **On the surface.** All points with prescribed normals are found, with a proof, if the
    derivatives of the surface can be bounded. This holds for the catalogue, SymPy expressions,
    callables made of NumPy functions, NURBS, affine images of these, and faces of parts. The report
    says for how many normals the points are `proved` to be all, and lists the others in
    `undecided`; see `SamplingReport`. Splines and indices of the last eight surfaces are cached, so
    that the function of a surface must return the same points each time; a `GaussMap` keeps them as
    long as it exists. On other surfaces, and at normals that were not prescribed, Newton's method
    moves a sample from the spline to the point with its normal. If there is no such point nearby,
    there is no sample; a prescribed normal is then also listed in `undecided`. Samples that fill
    gaps are evaluated at their parameters.

    **Parts and pieces.** All faces of a part, and all smooth pieces of a surface, have one target
    density and one count; angle and coverage refer to the whole. A piece has samples at normals if
    these are a tenth of all samples or more; if one of several pieces has none, 5 % of a count are
    placed where normals are farthest from those of all samples. Every face has a sample if there
    are at least twice as many samples as faces. A sample represents only points whose normals are
    within 60° of its own, that is, points on its side. Pieces share `cells` in proportion to their
    parameters, and `Samples.spline` is None. For parts, `density` is "balanced", "uniform", a
    number, or "gauss" with `normals`; `cells` and `on` are not allowed.

    **Edges.** Samples on edges have the `kind` "edge" and the normals of both faces, `normals` and
    `other_normals`. They are on both faces exactly. If the faces of the file do not meet, they are
    on the first face, and as close to the other face as the file allows. Each edge has samples at
    both ends and at least one in between, however small the count. Between neighbours on an edge
    the normals of each face differ by about as much as between neighbours elsewhere, or less. Gaps
    are no wider than in flat regions. A corner has one sample, with the normals of the edge that is
    sharpest there. Boundaries of open shells have only one face, and are not edges.
    `Samples.weights` are 0 on edges.

    For every normal of every closed surface, the samples of its spline at that normal, those at
    poles included, have Σ sign K = χ/2; χ is the Euler characteristic.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 500)
    >>> samples.points.shape
    (500, 3)
    >>> torus = gm.surfaces.torus(major=1.0, minor=0.35)
    >>> gm.sample(torus, normals=[[1, 0, 0], [0, 1, 1]]).normal_index.tolist().count(1)
    2
    >>> tilted = gm.sample(torus, 200, reach=((0, 0, 1), 30.0))  # within 30° of upwards
    >>> len(tilted), bool(tilted.normals[:, 2].min() >= 0.866)
    (200, True)
    >>> from gaussmap.tools.cad.examples import box
    >>> samples = gm.sample(box(), 60, edges=True)
    >>> len(samples), samples.report.edge_samples, int((samples.kind == "edge").sum())
    (100, 40, 40)

    """
    if isinstance(surface, NetSpline) and density is None:
        density = "gauss"
    request = checked_request(normals, count, angle, coverage, density, threads, reach)
    with busy("sampling", progress):
        return sample_and_normals(
            surface,
            request,
            cells=cells,
            on=on,
            fields=fields,
            dtype=dtype,
            threads=threads,
            progress=progress,
            edges=edges,
        )[0]


def sample_and_normals(
    surface: Surface | AnySpline | Whole | str,
    request: Request,
    *,
    cells: Sequence[int] | None,
    threads: int | None,
    progress: bool,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    on: str | None = None,
    edges: bool = False,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return the result of `sample`, and the unit normals that were searched."""
    given = Arguments(
        request, cells, on, fields, checked_dtype(dtype), threads, progress,
        yes_or_no(edges, "edges"),
    )  # fmt: skip
    samples, normals = _sampled(named(surface), given)
    filled = request.density != "gauss"
    warn_of(samples.report, request.count, 4, coverage=request.coverage, filled=filled)
    rounded = "points" in samples.fields and samples.points.dtype == np.float32
    if rounded and samples.report.origin is not None:
        warn_of_rounding(samples.points, 4)
    return samples, normals


class Arguments(NamedTuple):
    """The arguments of `sample`; all but `cells`, `on` and `fields` are checked."""

    request: Request
    cells: Sequence[int] | None
    on: str | None
    fields: Sequence[str] | None
    dtype: np.dtype[np.floating]
    threads: int | None
    progress: bool
    edges: bool


@in_memory
def _sampled(
    surface: Surface | AnySpline | Whole, given: Arguments
) -> tuple[Samples, NDArray[np.float64]]:
    """Choose how to sample a surface; return samples and the normals that were searched."""
    if isinstance(surface, Whole):
        return _of_part(surface, given)
    if given.edges:
        raise InputError("edges are sampled of CAD parts; other surfaces have no sharp edges.")
    reach = given.request.reach
    if reach is None:
        return _of_surface(surface, given)
    place_of_samples(surface, given.on)  # raises
    reach = reach._on(kept_map(surface, given.cells, given.on)._conditions_of(reach))
    given = given._replace(request=replace(given.request, reach=reach))
    samples, normals = _of_surface(surface, given)
    return replace(samples, report=replace(samples.report, **reach._reported)), normals


def _of_surface(
    surface: Surface | AnySpline, given: Arguments
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples of a surface or a spline."""
    density, normals = given.request.density, given.request.normals
    if density == "gauss" and normals is not None:
        return _at_normals(surface, normals, given), normals
    if isinstance(surface, NetSpline) and density != "gauss":
        raise InputError(
            f"{surface.name!r} is a spline of nets, which has no parameters in which gaps could be "
            'filled: use density="gauss", with normals=... or count=....'
        )
    pieces, fields = _pieces(surface, given)
    count = given.request.count
    if density == "gauss" and count is not None and len(pieces) == 1:
        chosen = choose(pieces[0], count, given.progress)
        return chosen.samples(pieces[0], fields, given.dtype, given.progress)
    return _filled(surface, on_grids(pieces), fields, given)


def _of_part(part: Whole, given: Arguments) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples of a CAD part."""
    check_part(given.cells, given.on)
    request = given.request
    at_normals = request.density == "gauss" and request.count is None and not given.edges
    fields = checked_fields(given.fields, True, at_normals, part=True, edges=given.edges)
    return part._sampled(request, fields, given.dtype, given.threads, given.progress, given.edges)


def _at_normals(
    surface: Surface | AnySpline, normals: NDArray[np.float64], given: Arguments
) -> Samples:
    """Return all points with prescribed normals."""
    checked_fields(
        given.fields, proved=None, surface=place_of_samples(surface, given.on) == "surface"
    )
    known, reach = kept_map(surface, given.cells, given.on), given.request.reach
    samples = known._points(
        normals, given.fields, given.dtype, given.threads, given.progress, reach=reach
    )
    return known._with_fit(samples, reach)


def _pieces(
    surface: Surface | AnySpline, given: Arguments
) -> tuple[list[OnPatches], tuple[str, ...]]:
    """Return the pieces of a surface, as geometries to be sampled, and the checked fields."""
    request, on_surface = given.request, place_of_samples(surface, given.on) == "surface"
    fields = checked_fields(given.fields, on_surface, grid=request.density == "aligned")
    if request.count is not None:
        check_memory(request.cost, request.count, bytes_of(fields, given.dtype))
    if request.normals is None:
        pieces = geometries_of(surface, given.cells, given.on)
    else:
        pieces = kept_map(surface, given.cells, given.on)._fitted
    return [x.used(given.dtype, given.threads).within(request.reach) for x in pieces], fields


def _filled(
    surface: Surface | AnySpline,
    geometries: Sequence[OnSpline],
    fields: tuple[str, ...],
    given: Arguments,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples of all pieces of a surface for any density, and the normals searched."""
    request, on_surface = given.request, geometries[0].on == "surface"
    space = space_of(geometries, given.threads, target_of(request))
    cover = fill(space, request, given.progress)
    wanted = dict.fromkeys([*fields, *(FLAG_NAMES if on_surface else ())])
    arrays = fields_of(cover, [x for x in wanted if x not in GRID_NAMES], given.dtype)
    arrays |= lines_of(cover.grid, cover.count, fields)
    at = cover.at_normals
    pieces = [x.geometry for x in space.pieces if isinstance(x, SurfacePiece)]
    report = report_of(surface.name, pieces, len(at.normals), at.density, at.developable, arrays)
    is_on_grid = cover.grid is not None and bool((cover.grid.rows >= 0).any())
    density = "aligned" if is_on_grid else None
    report = replace(report, coverage=cover.coverage, angle=cover.angle, density=density)
    whole, spline = geometries[0].surface, geometries[0].spline
    if len(geometries) > 1:
        spline, whole = None, None
        if on_surface and isinstance(surface, Surface):
            whole = in_reach(surface, request.reach)
    held = {name: arrays[name] for name in fields}
    samples = Samples(**held, report=report, spline=spline, surface=whole, offset_of=None)
    return (without_lines(samples) if given.fields is None else samples), at.normals
