"""The report of a sampling, and the warning if it is not what was requested."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from numpy.typing import NDArray

from .errors import GaussmapWarning
from .samples import SamplingReport, count_infinite
from .spline import Spline
from .visibility import invisible_share

__all__ = ["sampling_report", "warn_of"]

WORTH_A_WARNING = 0.01
# A count is missed if the difference exceeds this share of it plus this number of samples: on a
# symmetric surface several appear or vanish at once.
COUNT_TOLERANCE, FEW = 0.02, 5


def sampling_report(
    spline: Spline,
    normals: int,
    samples: int,
    density: float,
    developable: int | None,
    arrays: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> SamplingReport:
    """Return the report of a sampling with `density` normals per steradian and its `arrays`."""
    return SamplingReport(
        surface=spline.name,
        normals=normals,
        samples=samples,
        patches=spline.patches,
        invisible_share=invisible_share(spline, density),
        degenerate_patches=developable,
        infinite_curvatures=count_infinite(arrays),
    )


def warn_of(
    report: SamplingReport,
    count: int | None,
    stacklevel: int,
    coverage: float | None = None,
    filled: bool = False,
) -> None:
    """Warn if samples leave out a part of the surface, or miss a count or a coverage.

    If they are `filled`, the parts that normals cannot sample have samples, too.
    """
    reasons = [] if filled else _unseen(report)
    reasons += _missed(report, count, coverage)
    if reasons:
        message = f"surface {report.surface!r}: {'; '.join(reasons)}."
        warnings.warn(message, GaussmapWarning, stacklevel=stacklevel)


def _unseen(report: SamplingReport) -> list[str]:
    """Return reasons: the part of the surface that no set of normals samples."""
    share = report.invisible_share or 0.0
    if share > WORTH_A_WARNING:
        return [
            f"{100 * share:.0f} % of its area is flat or developable (K = 0), which no set "
            "of normals samples"
        ]
    if report.samples == 0 and report.degenerate_patches == report.patches:
        return ["it is flat or developable up to the rounding of its coordinates"]
    return ["none of the normals lies in its Gaussian image"] if report.samples == 0 else []


def _missed(report: SamplingReport, count: int | None, coverage: float | None) -> list[str]:
    """Return reasons: the requested numbers that are not met."""
    reasons = []
    if count is not None and abs(report.samples - count) > COUNT_TOLERANCE * count + FEW:
        reasons.append(f"there are {report.samples} samples instead of the requested {count}")
    if coverage is not None and report.coverage is not None and report.coverage > coverage:
        reasons.append(
            f"with {report.samples} samples the coverage is {report.coverage:.3g} instead of the "
            f"requested {coverage:g}"
        )
    return reasons
