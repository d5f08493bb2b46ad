"""`convolve`: all sums of two points with the same normal, with what both surfaces have there."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import GaussmapWarning, InputError
from ..samples import Samples, SamplingReport, rows_of
from ..sampling import sampling_report, warn_of
from ..sphere import as_normals
from ..spline import Spline, short_label, spline_of
from ..surface import Surface
from .branches import Branches, curvatures
from .function import SupportFunction
from .operations import pairs

__all__ = ["Convolution", "convolve"]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Convolution:
    """The k sums of two points with the same normal, by normal, then by branch of the first.

    A boolean mask (k,), an index array or a slice picks some of them:
    `sums[sums.samples.elliptic]`.

    - `samples`: `Samples` of the convolution surface; no `uv` and `patch_index`, of which there are
      two.
    - `first`, `second`: the `Branches` of both surfaces at the normals that were asked.
    - `rows`: (k, 2) int64, which row of `first` and which of `second` a sample is the sum of:
      samples.points = first.points[rows[:, 0]] + second.points[rows[:, 1]].
    """

    samples: Samples
    first: Branches
    second: Branches
    rows: NDArray[np.int64]

    @property
    def first_uv(self) -> NDArray[np.float64]:
        """(k, 2) float64: parameters of the point of the first surface; NaN if it has none."""
        return self.first.uv[self.rows[:, 0]]

    @property
    def second_uv(self) -> NDArray[np.float64]:
        """(k, 2) float64: parameters of the point of the second surface; NaN if it has none."""
        return self.second.uv[self.rows[:, 1]]

    def __len__(self) -> int:
        """Return the number of sums."""
        return len(self.rows)

    def __getitem__(self, key: ArrayLike | slice) -> Convolution:
        rows = key if isinstance(key, slice) else rows_of(key, len(self))
        return replace(self, samples=self.samples[rows], rows=self.rows[rows])

    def __repr__(self) -> str:
        return f"Convolution({self.samples!r})"


def convolve(
    first: Surface | Spline | SupportFunction,
    second: Surface | Spline | SupportFunction,
    normals: ArrayLike,
    *,
    cells: Sequence[int] | None = None,
) -> Convolution:
    """Return the convolution of two surfaces: every sum of two points that share a given normal.

    Support functions add, h = h₁ + h₂ (7), and so do points and Hessians; a normal with i points on
    the first surface and j on the second has i j sums. `normals` (S, 3) are directions of any
    length, such as `icosphere(32)`. A `Surface` is approximated by a spline of `cells` first (see
    `fit`; other cells for the second surface: fit it before).

    For two convex bodies whose normals point outwards this is the boundary of their Minkowski sum.
    For others it is the convolution surface, of which that boundary is a part: other sheets lie
    inside the sum. The body that the first one must not touch when it moves past the second one is
    the sum with the second one reflected in the origin. Reflected, its outward normals are −n:
    `SupportFunction.of_spline(second).scaled(-1).reversed()`.

    K and H come from the sum of the Hessians: a radius that is infinite (a parabolic point) makes
    them NaN, a sum of radii that is 0 infinite or NaN. Flat and developable parts are not seen by
    normals, and neither are their sums: a GaussmapWarning says so, or that no sums came. Raises
    InputError for unusable normals, for `cells` where no `Surface` takes them and for what is no
    surface; SurfaceError as `fit` does.
    """
    directions = as_normals(normals)
    if cells is not None and not any(isinstance(x, Surface) for x in (first, second)):
        raise InputError("cells=... is for surfaces, and neither of these is a Surface.")
    one, first_name = _branches(first, directions, cells)
    two, second_name = _branches(second, directions, cells)
    i, j = pairs(one.normal_index, two.normal_index, len(directions))
    name = f"{short_label(first_name)} + {short_label(second_name)}"
    if len(one) and len(two) and not len(i):
        message = f"surface {name!r}: no normal has points on both of the two."
        warnings.warn(message, GaussmapWarning, stacklevel=2)
    mine = one.normals[i]
    with np.errstate(all="ignore"):  # infinite radii are answers, too
        _, gaussian, mean = curvatures(mine, one.hessian[i] + two.hessian[j])
    samples = Samples(
        points=one.points[i] + two.points[j],
        normals=mine,
        support=one.support[i] + two.support[j],
        gaussian_curvature=gaussian,
        mean_curvature=mean,
        normal_index=one.normal_index[i],
        report=SamplingReport(name, len(directions), len(i), None, None, None),
    )
    return Convolution(samples, one, two, np.stack([i, j], axis=1))


def _branches(
    surface: Surface | Spline | SupportFunction,
    normals: NDArray[np.float64],
    cells: Sequence[int] | None,
) -> tuple[Branches, str]:
    """Return what a surface has at the normals, and its name; warn of what normals cannot see."""
    if isinstance(surface, SupportFunction):
        return surface.branches(normals), repr(surface)
    if not isinstance(surface, Surface | Spline):
        raise InputError(
            "convolve takes two of Surface, Spline and SupportFunction, not "
            f"{type(surface).__name__}."
        )
    spline = spline_of(surface, cells if isinstance(surface, Surface) else None)
    branches = SupportFunction.of_spline(spline).branches(normals)
    density = len(normals) / (4 * math.pi)
    report = sampling_report(spline, len(normals), len(branches), density, None)
    warn_of(report, None, stacklevel=4)
    return branches, spline.name
