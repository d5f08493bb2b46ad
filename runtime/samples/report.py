"""The report of a sampling, and the warning if it falls short of the request."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from operator import attrgetter
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import GaussmapWarning
from ..directions.regions import Reach
from ..spline.developable import CellMeasure
from ..spline.nets import AnySpline

# Missing or inaccurate parts cause a warning if their share of the area, of the length of a curve,
# or of the samples is larger than this.
WORTH_A_WARNING = 0.01
# A requested count is missed if the number of samples differs from it by more than this share of
# the count plus FEW: on a symmetric surface several samples appear or vanish together.
COUNT_TOLERANCE, FEW = 0.02, 5
# The surfaces on which samples may lie.
PLACES = ("surface", "spline")


class UndecidedNormal(NamedTuple):
    """A normal, and a box of parameters that has an unknown number of points with this normal.

    Attributes
    ----------
    normal : int
        The row of the normal among the prescribed ones.
    box : (u0, u1, v0, v1) of float
        The rectangle of parameters. Where points are proved, all points outside of the boxes of a
        report are known.
    kind : {"isolated", "curve", "open", "unmoved"}
        "isolated": a point where K is 0, or several that cannot be told apart. "curve": a curve or
        a region with this normal, such as a ruling of a cylinder. "open": it is unknown whether the
        box contains a point, as next to a fold, up to rounding, or where x_u × x_v may vanish.
        "unmoved": points of the spline could not be moved to the surface. "isolated" and "curve"
        are components without a sample: none of their points was found inside the trim.
    border : bool
        Whether the box reaches an open side of the domain, or may meet the boundary of the trim.
    face : int or None
        For a CAD part: the index of the face to which the parameters belong.
    degree : int or None
        The degree of the Gauss map on the box, if it is known: the sum of the signs of K over the
        points in the box that have a generic normal close to this one. If it is not 0, the box
        contains a point.

    Examples
    --------
    >>> import gaussmap as gm
    >>> saddle = gm.surfaces.monkey_saddle().trimmed(within=lambda u, v: u > 1e-9)
    >>> place = gm.GaussMap(saddle).points([[0, 0, 1]]).report.undecided[0]
    >>> place.normal, place.kind, place.border, len(place.box), place.face, place.degree
    (0, 'isolated', True, 4, None, -2)

    """

    normal: int
    box: tuple[float, float, float, float]
    kind: str
    border: bool
    face: int | None = None
    degree: int | None = None

    @classmethod
    def of(cls, values: Sequence[Any]) -> UndecidedNormal:
        """Return an undecided normal from plain values, such as those of a file."""
        normal, (u0, u1, v0, v1), kind, border, *known = values
        box = float(u0), float(u1), float(v0), float(v1)
        face, degree = (None if x is None else int(x) for x in known)
        return cls(int(normal), box, str(kind), bool(border), face, degree)


def _floats(values: Iterable[Any]) -> tuple[float, ...]:
    return tuple(float(x) for x in values)


# For each annotated type of an entry, the function that makes a plain value of it. The entry may be
# a number of NumPy, or a list from JSON.
PLAIN: dict[str, Callable[[Any], Any]] = {
    "str": str,
    "int": int,
    "float": float,
    "bool": bool,
    "tuple[float, ...]": _floats,
    "tuple[float, float, float]": _floats,
    "tuple[UndecidedNormal, ...]": lambda places: tuple(UndecidedNormal.of(x) for x in places),
}


@dataclass(frozen=True, slots=True)
class SamplingReport:
    """A report on a sampling.

    A number is None if it is unknown: a .ply file that another program rewrote has the samples, but
    not the report.

    Attributes
    ----------
    surface : str
        Label of the surface.
    normals : int or None
        The number of prescribed normals.
    samples : int
        The number of samples.
    patches : int or None
        The number of patches of the spline.
    developable_share : float or None
        The developable share of the area (K ≈ 0), from 0 to 1; no set of normals samples it.
    developable_patches : int or None
        The number of patches that are developable up to the rounding of their coordinates, and so
        have no support function (including the patches at poles).
    coverage : float or None
        A bound of the distance from any point of the surface to the nearest sample on its side
        (with a normal within 60°, if there is one), in the unit of the surface. Known if a coverage
        was requested. `Samples.coverage` is the distance to the nearest sample on either side.
    angle : float or None
        A bound of the angle, in degrees, from the normal of any point of the surface to the nearest
        normal of a sample. Known if an angle was requested.
    infinite_curvatures : int or None
        The number of samples with infinite Gaussian curvature: at singular points, which a coarse
        spline may have, and where 1/L² exceeds the largest number of the dtype, on surfaces smaller
        than 1e-154 (1e-19 with float32). Known if `gaussian_curvature` was requested.
    on : {"surface", "spline"} or None
        Where the samples lie: on the surface, or on the spline that approximates it.
    unrefined : int or None
        With ``on="surface"``, the number of samples that are not on the surface
        (`Samples.on_surface` is False): samples at singular points, and samples of a silhouette
        that could not be moved to the surface.
    proved : int or None
        The number of prescribed normals whose samples are proved to stand for all points; the
        others are `undecided`. For curves, it is known up to rounding that all of their points have
        the normal. None if nothing is proved: on splines, on surfaces whose derivatives have no
        bounds, and on parts with `estimated_faces`.
    undecided : tuple of UndecidedNormal, or None
        The boxes that may contain further points, see `UndecidedNormal`. On surfaces without a
        proof, they are boxes around points of the spline that could not be moved to the surface, at
        most one for each normal; points with other normals may be missing, too.
    fit_distance, fit_rms : float or None
        The largest distance of the spline from the surface, or from the data, that it approximates,
        and the root mean square of the distance; see `Spline.misfit`.
    fit_angle : float or None
        The largest angle, in degrees, between normals of spline and surface; unknown for data.
    apexes : int or None
        The number of collapsed sides of the domain at which the surface is not smooth; see
        `Spline.apexes`.
    index : int or None
        The position of the surface among those of `sample_many`, from 0 on.
    density : {"aligned", "gauss", "uniform", "power"} or None
        "aligned" if samples are on a grid, whether or not they have the fields row and column. For
        a CAD part: the density, "power" for a power of |K|; None for "balanced".
    faces, empty_faces : int or None
        For a CAD part: the number of its faces, and the number of faces without samples.
    estimated_faces : int or None
        For a CAD part at prescribed normals: the number of faces whose derivatives have no bounds.
        Their points are found from a spline by Newton's method, and their `uv_radius` is NaN.
    oriented : bool or None
        For a CAD part: whether its normals are known to point out of solids.
    edge_samples : int or None
        For a CAD part with ``edges=True``: the number of samples on sharp edges.
    reach : tuple of float or None
        With ``reach=(axis, angle)``: the unit vector of the axis, and the angle in degrees. For a
        `Reach`, four numbers for each of its conditions: the axis and the angle of each cap; then
        0, 0, 0 and the distance from edges; then the axis and −1 for unobstructed rays; then
        0, 0, 0 and the clearance with a minus sign, or 0 if it is infinite.
        `Samples.coverage`, `normal_deviation` and `weights` refer to the points in reach.
    edge_error : float or None
        With ``from_edges``: the largest error of the arcs that approximate edges, in L. The error
        of each arc is added to the distance that samples keep from it.
    unit : str or None
        For a CAD part, and a `terrain` with a `crs`: the unit of lengths, such as "mm", if it is
        known.
    crs : str or None
        For a `terrain`: the coordinate reference system of the points, as "EPSG:number" or WKT.
    origin : (float, float, float) or None
        For a `terrain`: the origin that was subtracted from the coordinates of the points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> report = gm.sample("torus", angle=20.0, cells=(16, 16)).report
    >>> report.surface, report.patches, report.developable_patches, report.infinite_curvatures
    ('torus', 1024, 0, 0)
    >>> report.normals <= report.samples, report.angle <= 20.0, report.coverage is None
    (True, True, True)
    >>> report.on, report.unrefined
    ('surface', 0)
    >>> report = gm.sample("torus", normals=[[1, 0, 0], [0, 1, 1]]).report
    >>> report.proved, report.undecided
    (2, ())
    >>> report.faces, report.empty_faces, report.oriented  # not of a CAD part
    (None, None, None)
    >>> report.estimated_faces is None
    True
    >>> report
    SamplingReport(surface='torus', normals=2, samples=4, patches=16384, ..., apexes=0)
    >>> report.density is report.edge_samples is report.crs is report.origin is None
    True
    >>> report.reach is report.edge_error is report.unit is None
    True
    >>> report.developable_share, report.apexes, report.index
    (0.0, 0, None)
    >>> report.fit_rms < report.fit_distance < 1.1e-3, report.fit_angle < 0.6
    (True, True)

    """

    surface: str
    normals: int | None
    samples: int
    patches: int | None
    developable_share: float | None
    developable_patches: int | None
    coverage: float | None = None
    angle: float | None = None
    infinite_curvatures: int | None = None
    on: str | None = None
    unrefined: int | None = None
    proved: int | None = None
    undecided: tuple[UndecidedNormal, ...] | None = None
    fit_distance: float | None = None
    fit_rms: float | None = None
    fit_angle: float | None = None
    apexes: int | None = None
    index: int | None = None
    density: str | None = None
    faces: int | None = None
    empty_faces: int | None = None
    estimated_faces: int | None = None
    oriented: bool | None = None
    edge_samples: int | None = None
    reach: tuple[float, ...] | None = None
    edge_error: float | None = None
    unit: str | None = None
    crs: str | None = None
    origin: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for x in fields(self):
            if (value := getattr(self, x.name)) is not None:
                plain = PLAIN[str(x.type).removesuffix(" | None")]
                object.__setattr__(self, x.name, plain(value))
        if self.developable_share is not None:  # a quotient of sums, which are rounded
            object.__setattr__(self, "developable_share", min(self.developable_share, 1.0))

    @property
    def _in_reach(self) -> Reach | None:
        return None if self.reach is None else Reach._of(self.reach)

    def __repr__(self) -> str:
        known = ((x.name, getattr(self, x.name)) for x in fields(self))
        shown = ", ".join(f"{name}={value!r}" for name, value in known if value is not None)
        return f"SamplingReport({shown})"


def sampling_report(
    spline: AnySpline,
    normals: int,
    samples: int,
    density: float,
    developable: int | None,
    arrays: Mapping[str, NDArray[Any]] = MappingProxyType({}),
    cells: CellMeasure | None = None,
    **known: Any,  # noqa: ANN401
) -> SamplingReport:
    """Return the report of a sampling with `density` normals per steradian.

    `arrays` are the fields of the samples, and `known` other entries of the report. `cells` are the
    measures of cells on the surface; by default they are measured on the spline.
    """
    misfit, place = spline.misfit, spline.georeference
    return SamplingReport(
        surface=spline.name,
        normals=normals,
        samples=samples,
        patches=spline.patches,
        developable_share=(cells or spline._cell_measure).developable_share(density),
        developable_patches=developable,
        infinite_curvatures=count_infinite(arrays),
        fit_distance=None if misfit is None else misfit.distance,
        fit_rms=None if misfit is None else misfit.rms,
        fit_angle=None if misfit is None else misfit.angle,
        apexes=spline.apexes,
        **({} if place is None else asdict(place)),
        **known,
    )


def warn_of(
    report: SamplingReport,
    count: int | None,
    stacklevel: int,
    coverage: float | None = None,
    filled: bool = False,
) -> None:
    """Warn if samples leave out a part of the surface, are off it, or miss a requested number.

    If the samples are `filled`, developable regions have samples as well.
    """
    reasons = [] if filled else _unseen(report)
    reasons += _missed(report, count, coverage) + _unrefined(report)
    if reasons:
        message = f"surface {report.surface!r}: {'; '.join(reasons)}."
        warnings.warn(message, GaussmapWarning, stacklevel=stacklevel)


def _unseen(report: SamplingReport) -> list[str]:
    """Return reasons for a warning: parts of the surface have no samples, or there are none."""
    share = report.developable_share or 0.0
    if share > WORTH_A_WARNING:
        return [
            f"{100 * share:.0f} % of its area is flat or developable (K = 0), which no set "
            "of normals can sample"
        ]
    if report.samples == 0 and None is not report.patches == report.developable_patches:
        return ["it is flat or developable up to the rounding of its coordinates"]
    if report.samples == 0 and report.undecided:
        return [
            "all points with these normals are in boxes of report.undecided, such as curves of "
            "points with one normal"
        ]
    return ["none of the normals lies in its Gaussian image"] if report.samples == 0 else []


def _missed(report: SamplingReport, count: int | None, coverage: float | None) -> list[str]:
    """Return reasons for a warning: requested numbers that are not met."""
    reasons, samples = [], report.samples - (report.edge_samples or 0)
    if count is not None and abs(samples - count) > COUNT_TOLERANCE * count + FEW:
        reasons.append(f"there are {samples} samples instead of the requested {count}")
    if coverage is not None and report.coverage is not None and report.coverage > coverage:
        reasons.append(
            f"with {report.samples} samples the coverage is {report.coverage:.3g} instead of the "
            f"requested {coverage:g}"
        )
    return reasons


def _unrefined(report: SamplingReport) -> list[str]:
    """Return reasons for a warning: samples or points of the spline that are not on the surface."""
    reasons, unrefined = [], report.unrefined or 0
    if unrefined > WORTH_A_WARNING * report.samples:
        reasons.append(
            f"{unrefined} of {report.samples} samples could not be moved to the surface, and lie "
            "on its spline (on_surface tells which)"
        )
    left = 0 if report.proved is not None else len(report.undecided or ())
    if left > WORTH_A_WARNING * (report.normals or 0):
        reasons.append(
            f"points of its spline with {left} of {report.normals} normals could not be moved to "
            "the surface, and are left out (undecided lists them)"
        )
    return reasons


def common_report(
    reports: Sequence[SamplingReport], arrays: Mapping[str, NDArray[Any]]
) -> SamplingReport:
    """Return a report with the entries that agree in all reports, and with counts of all samples.

    `arrays` are the fields of all samples.
    """
    common: dict[str, Any] = {
        x.name: getattr(reports[0], x.name)
        if len({getattr(report, x.name) for report in reports}) == 1
        else None
        for x in fields(SamplingReport)
    }
    common["surface"] = common["surface"] or "several surfaces"
    common["samples"] = len(next(iter(arrays.values())))
    common["infinite_curvatures"] = count_infinite(arrays)
    common["unrefined"] = count_unrefined(arrays)
    if all(x.proved is not None for x in reports):
        common["proved"] = sum(x.proved or 0 for x in reports)
    if all(x.undecided is not None for x in reports):
        common["undecided"] = tuple(y for x in reports for y in x.undecided or ())
    return SamplingReport(**common)


def joined_proof(normals: int, reports: Iterable[SamplingReport]) -> dict[str, Any]:
    """Return the entries `proved` and `undecided` for normals searched on several surfaces.

    All `normals` were searched on each surface; there is one report for each surface. The undecided
    boxes come in the order of their normals.
    """
    undecided = sorted((y for x in reports for y in x.undecided or ()), key=attrgetter("normal"))
    return {"proved": normals - len({x.normal for x in undecided}), "undecided": tuple(undecided)}


def count_infinite(arrays: Mapping[str, NDArray[Any]]) -> int | None:
    """Return the number of samples with infinite K; None if K is not among their fields."""
    if "gaussian_curvature" not in arrays:
        return None
    return int(np.count_nonzero(np.isinf(arrays["gaussian_curvature"])))


def count_unrefined(arrays: Mapping[str, NDArray[Any]]) -> int | None:
    """Return the number of samples that are not on the surface; None if it is unknown."""
    if "on_surface" not in arrays:
        return None
    return int(np.count_nonzero(~arrays["on_surface"]))


def have_large_squares(H: NDArray[np.floating], dtype: np.dtype[Any]) -> bool:
    """Return whether squares of the finite curvatures H overflow in a dtype."""
    finite = np.abs(H[np.isfinite(H)].astype(np.float64))
    return float(finite.max(initial=0.0)) > math.sqrt(float(np.finfo(dtype).max))
