"""The summary of samples: one line on their numbers and their report."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.georeference import crs_label
from ..base.wording import at_normals, plural
from .fields import Component
from .report import SamplingReport, count_infinite, have_large_squares

if TYPE_CHECKING:
    from .arrays import SampleArrays

# The names of special components, in the singular and in the plural.
SPECIAL = {
    Component.ISOLATED: ("isolated with K = 0",) * 2,
    Component.CURVE: ("on a curve with one normal", "on curves with one normal"),
    Component.TIP: ("at a tip", "at tips"),
    Component.CREASE: ("on a crease", "on creases"),
}
GRID = "a grid that follows the curvature"  # a graded grid, in plain words


def summary_of(samples: SampleArrays) -> str:
    """Return one line: the number of samples, their origin, and their coverage."""
    report, split = samples.report, kinds_of_points(samples).removeprefix(": ").strip(" ()")
    line = f"{plural(len(samples), 'sample')}{_origin(samples)} ({split})"
    if len(samples) != report.samples:
        line = f"{len(samples):,} of {report.samples:,}" + line.removeprefix(f"{len(samples):,}")
    if report.proved is not None and report.normals:
        line += f"; proved to be complete for {report.proved:,} of "
        line += plural(report.normals, "normal")
    if report._in_reach is not None:
        line += f"; in reach: {report._in_reach._said(report.unit, report.edge_error)}"
    if report.angle is not None:
        line += f"; every normal is within {report.angle:.3g}° of that of a sample"
    if report.coverage is not None:
        line += f"; every point is within {_length(report.coverage, report)} of a sample"
    if report.developable_share is not None and not _filling(samples):
        share = f"{100.0 * report.developable_share:.2f}"
        if share != "0.00":
            line += f"; {share} % of the surface is flat or developable (K = 0), which no set of "
            line += "normals can sample"
    if report.on == "spline":
        line += misfit_clause(report)
    if report.faces is not None:
        line += f"; {plural(report.faces, 'face')}"
        if report.empty_faces:
            line += f", {report.empty_faces:,} of them without samples"
        if report.estimated_faces:
            line += f", {report.estimated_faces:,} of them estimated"
    if report.edge_samples is not None:
        line += f"; {report.edge_samples:,} of the samples are on sharp edges"
    if report.unrefined:
        line += f"; {plural(report.unrefined, 'sample')} could not be moved to the surface: there "
        line += "normals and curvatures are those of its spline"
    if report.proved is None and report.undecided:
        line += f"; {plural(len(report.undecided), 'normal')} may have further points"
    if report.apexes:
        tips = "a sharp tip" if report.apexes == 1 else f"{report.apexes} sharp tips"
        line += f"; the surface ends in {tips}"
    return line + _place(report) + _infinite(samples)


def _place(report: SamplingReport) -> str:
    """Return a clause on the reference system and the subtracted origin of the coordinates."""
    clause = f"; coordinates in {crs_label(report.crs)}" if report.crs else ""
    if report.origin and any(report.origin):
        numbers = ", ".join(f"{x:.12g}" for x in report.origin)
        clause += f"{'' if clause else '; coordinates'} relative to ({numbers})"
    return clause


def misfit_clause(report: SamplingReport) -> str:
    """Return a clause on the misfit of the spline to the surface or the data, if known."""
    if report.fit_distance is None or report.fit_rms is None:
        return ""
    distance, rms = (_length(x, report) for x in (report.fit_distance, report.fit_rms))
    if report.fit_angle is None:
        return f"; they lie on a spline within {distance} of the data (root mean square {rms})"
    angle = f"its normals within {report.fit_angle:.3g}°"
    return f"; they lie on a spline within {distance} of the surface, {angle}"


def _length(value: float, report: SamplingReport) -> str:
    """Return a length with its unit, if that is known."""
    return f"{value:.3g} {report.unit or ''}".strip()


def _filling(samples: SampleArrays) -> int:
    """Return the number of samples neither at a prescribed normal nor on an edge; 0 if unknown."""
    if "normal_index" not in samples.fields:
        return 0
    filling = samples.normal_index < 0
    if samples.other_face_index is not None:
        filling &= samples.other_face_index < 0
    return int(filling.sum())


def _on_grid(samples: SampleArrays) -> str:
    """Return a clause on the number of samples on a grid."""
    count = 0 if samples.row is None else int((samples.row >= 0).sum())
    if count == 0:
        return f" of {GRID}" if samples.report.density == "aligned" else ""
    rest = len(samples) - count
    return f": {count:,} on {GRID}" + (f", {rest:,} filling gaps" if rest else "")


def _origin(samples: SampleArrays) -> str:
    """Return a clause on the numbers of samples at prescribed normals and of filling samples."""
    normals, filling = samples.report.normals, _filling(samples)
    if grid := _on_grid(samples):
        return grid
    if filling == len(samples) > 0:
        return " filling gaps" if normals else ""
    if not normals:
        return ""
    if "normal_index" not in samples.fields:
        return f" {at_normals(normals, normals)}"
    index = samples.normal_index
    used, counts = np.unique(index[index >= 0], return_counts=True)
    given = at_normals(len(used), normals)
    if filling:
        return f": {len(samples) - filling:,} {given}, {filling:,} filling gaps"
    same = len(used) > 1 and (counts == counts[0]).all()
    return f" {given}{f', exactly {counts[0]:,} each' if same else ''}"


def _infinite(samples: SampleArrays) -> str:
    """Return a clause on the number of samples with infinite K, and the reason."""
    if not count_infinite(samples.arrays()):
        return ""
    infinite = np.isinf(samples.gaussian_curvature)
    reason = "the spline is singular"
    if "mean_curvature" in samples.fields and have_large_squares(
        samples.mean_curvature, samples.dtype
    ):
        reason = f"it is too large for {samples.dtype}"
    return f"; K is infinite at {int(infinite.sum()):,} samples, where {reason}"


def kinds_of_points(samples: SampleArrays) -> str:
    """Return the numbers of points by the sign of K, or the fields if K is missing.

    Parabolic points are counted as such, whatever the sign bit of K. Components that are not
    regular are counted by kind.
    """
    if "gaussian_curvature" not in samples.fields:
        return f" ({', '.join(samples.fields)} only)"
    parabolic, negative = samples.parabolic, samples.hyperbolic
    regular = samples._regular
    kinds = {">": ~parabolic & ~negative, "<": ~parabolic & negative, "=": parabolic}
    numbers = {sign: int(np.count_nonzero(x & regular)) for sign, x in kinds.items()}
    said = [f"{number:,} with K {sign} 0" for sign, number in numbers.items() if number]
    for component, words in SPECIAL.items() if not regular.all() else ():
        count = int(np.count_nonzero(samples.component == component))
        said += [f"{count:,} {words[count > 1]}"] if count else []
    return f": {', '.join(said or ['none'])}"
