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
from ..files.lengths import whole_of
from .palette import SCALE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, Normalize

CURVATURE = "gaussian_curvature"
SIGNED = (CURVATURE, "mean_curvature")  # their scales are symmetric to zero
UNITS = {CURVATURE: "1/length²", "mean_curvature": "1/length", "support": "length"}
INDICES = ("face_index", "solid_index")
MOST_DISTINCT, MOST_NAMES = 20, 12  # the largest numbers: of distinct colours, of labels
ROBUST = 95.0  # the percentile of sizes at the ends of a scale that is symmetric to zero


@dataclass(frozen=True)
class Colours:
    """The values of samples that are shown in colour, and the scale of colours with its label.

    `clipped` says whether some values are beyond the ends of the scale. If there are `names`, the
    colours are discrete, and `values` are indices of names.
    """

    values: NDArray[np.float64]
    norm: Normalize
    scale: Colormap
    label: str
    unit: str
    clipped: bool
    names: tuple[str, ...] = ()  # of discrete colours, for the values 0, 1, …


def checked_values(samples: Samples, color: str | ArrayLike) -> tuple[NDArray[np.float64], str]:
    """Return a value for each sample, and its name ("" for an array).

    Raises UnknownNameError or MissingFieldError for the name of a column, InputError for an array.
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
    if name in INDICES:
        return _discrete(samples, values, name)
    label = "Gaussian curvature $K$" if name == CURVATURE else name.replace("_", " ")
    if name in SIGNED:
        limit, clipped = _limit(values)
        scale = LinearSegmentedColormap.from_list("curvature", SCALE)
        unit = _unit(name, samples)
        return Colours(values, Normalize(-limit, limit), scale, label, unit, clipped)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    norm = Normalize(low, high if high > low else low + 1.0)
    return Colours(values, norm, colormaps["viridis"], label, _unit(name, samples), False)


def _unit(name: str, samples: Samples) -> str:
    """Return the unit of a column, with the unit of length of the samples if it is known."""
    return UNITS.get(name, "").replace("length", samples.report.unit or "length")


def _discrete(samples: Samples, values: NDArray[np.float64], name: str) -> Colours:
    """Return a colour for each face or solid; the names of faces are their indices in the file."""
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap

    found, codes = np.unique(values, return_inverse=True)
    numbers = found.astype(np.int64)
    numbers = numbers_in_file(samples, numbers) if name == "face_index" else numbers
    few = len(found) <= MOST_DISTINCT
    source = colormaps["tab20" if few else "turbo"]
    places = np.arange(len(found)) if few else np.linspace(0.0, 1.0, len(found))
    norm = BoundaryNorm(np.arange(len(found) + 1) - 0.5, max(len(found), 1))
    label = name.removesuffix("_index") + (" in the file" if name == "face_index" else "")
    shown = tuple(str(x) for x in numbers.tolist())
    return Colours(
        codes.astype(np.float64), norm, ListedColormap(source(places)), label, "", False, shown
    )


def numbers_in_file(samples: Samples, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the indices in the file of faces (k,), given by their indices in the part of samples.

    Without a part, return `faces`.
    """
    part = whole_of(samples)
    if part is None:
        return faces
    own = next(x.values for x in part._face_columns() if x.name == "source_index")
    return np.array(own)[faces]


def _limit(values: NDArray[np.float64]) -> tuple[float, bool]:
    """Return the upper end of a scale symmetric about zero, and whether some moduli exceed it."""
    sizes = np.append(np.abs(values[np.isfinite(values)]), 0.0)
    largest, limit = float(sizes.max()), float(np.percentile(sizes, ROBUST))
    if largest <= 1.25 * limit or limit == 0.0:
        limit = largest or 1.0
    return limit, largest > limit


def _draw_names(axes: Axes, colours: Colours) -> None:
    """Draw discrete colours with their names; if there are many names, leave some of them out."""
    from matplotlib.cm import ScalarMappable

    step = -(-len(colours.names) // MOST_NAMES)
    ticks = np.arange(0, len(colours.names), step)
    bar: Any = axes.figure.colorbar(
        ScalarMappable(colours.norm, colours.scale), cax=axes, orientation="horizontal",
        ticks=ticks, spacing="uniform",
    )  # fmt: skip
    bar.set_ticks(ticks, labels=[colours.names[k] for k in ticks])
    bar.minorticks_off()
    bar.set_label(colours.label)
    bar.outline.set_linewidth(0.4)
    bar.ax.tick_params(width=0.0, length=0.0, labelsize=7)


def draw_scale(axes: Axes, colours: Colours) -> None:
    """Draw the scale of colours into axes, with its label."""
    from matplotlib.cm import ScalarMappable

    norm, figure = colours.norm, axes.figure
    if colours.names:
        _draw_names(axes, colours)
        return
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
