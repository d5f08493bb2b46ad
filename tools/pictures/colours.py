"""The colours of samples: by Gaussian curvature, or by any other column or array."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import known_name, real_values
from ...runtime.base.errors import InputError
from ...runtime.samples.fields import columns_of
from ...runtime.samples.samples import Samples
from .palette import SCALE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, Normalize

__all__ = ["CURVATURE", "Colours", "checked_values", "colours_of", "draw_scale"]

CURVATURE = "gaussian_curvature"
SIGNED = (CURVATURE, "mean_curvature")  # their scales are symmetric to zero
UNITS = {CURVATURE: "1/length²", "mean_curvature": "1/length", "support": "length"}
ROBUST = 95.0  # the percentile of sizes at the ends of a scale that is symmetric to zero


@dataclass(frozen=True)
class Colours:
    """The values of samples shown in colour, their scale, and the scale's label.

    `clipped` says whether some values are beyond the ends of the scale.
    """

    values: NDArray[np.float64]
    norm: Normalize
    scale: Colormap
    label: str
    unit: str
    clipped: bool


def checked_values(samples: Samples, color: str | ArrayLike) -> tuple[NDArray[np.float64], str]:
    """Return a value for each sample, and its name ("" for an array).

    Raises UnknownNameError and MissingFieldError for names, InputError for arrays.
    """
    if not isinstance(color, str):
        values = real_values(color, "color")
        if values.shape != (len(samples),):
            raise InputError(
                f"color must have a number for each of the {len(samples):,} samples, not the "
                f"shape {values.shape}."
            )
        return values.astype(np.float64), ""
    if color == CURVATURE:
        return samples.gaussian_curvature.astype(np.float64), color
    columns = columns_of(samples.arrays())
    return columns[known_name(color, tuple(columns), "column")].astype(np.float64), color


def colours_of(samples: Samples, color: str | ArrayLike) -> Colours:
    """Return the colours of samples by the name of a column, or by an array (N,)."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    values, name = checked_values(samples, color)
    label = "Gaussian curvature $K$" if name == CURVATURE else name.replace("_", " ")
    if name in SIGNED:
        limit, clipped = _limit(values)
        scale = LinearSegmentedColormap.from_list("curvature", SCALE)
        return Colours(values, Normalize(-limit, limit), scale, label, UNITS[name], clipped)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    norm = Normalize(low, high if high > low else low + 1.0)
    return Colours(values, norm, colormaps["viridis"], label, UNITS.get(name, ""), False)


def _limit(values: NDArray[np.float64]) -> tuple[float, bool]:
    """Return the end of a scale that is symmetric to zero, and whether some values exceed it."""
    sizes = np.append(np.abs(values[np.isfinite(values)]), 0.0)
    largest, limit = float(sizes.max()), float(np.percentile(sizes, ROBUST))
    if largest <= 1.25 * limit or limit == 0.0:
        limit = largest or 1.0
    return limit, largest > limit


def draw_scale(axes: Axes, colours: Colours) -> None:
    """Draw the scale of colours into axes, with its label."""
    from matplotlib.cm import ScalarMappable

    norm, figure = colours.norm, axes.figure
    size = max(abs(norm.vmin or 0.0), abs(norm.vmax or 0.0)) or 1.0
    exponent = math.floor(math.log10(size))
    exponent = 0 if -2 <= exponent <= 3 else exponent
    bar: Any = figure.colorbar(
        ScalarMappable(norm, colours.scale),
        cax=axes,
        orientation="horizontal",
        extend="both" if colours.clipped else "neither",
        format=lambda value, _: f"{value / 10.0**exponent:g}".replace("-", "−"),
    )
    factor = rf"$10^{{{exponent}}}$" if exponent else ""
    unit = (
        (factor or "1") + colours.unit[1:]
        if colours.unit.startswith("1/")
        else (f"{factor} {colours.unit}".strip())
    )
    label = f"{colours.label} ({unit})" if unit else colours.label
    bar.set_label(label)
    bar.outline.set_linewidth(0.4)
    bar.ax.tick_params(width=0.4, length=2.5, labelsize=7)
