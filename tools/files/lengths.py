"""Units of length, and their names in files."""

from ...runtime.base.errors import InputError, shown
from ...runtime.samples.fields import COLUMNS, UNITS
from ...runtime.samples.samples import Samples
from ...runtime.samples.whole import Whole

# The length of each unit in metres.
METRES: dict[str, float] = {
    "nm": 1e-9,
    "um": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "dm": 1e-1,
    "m": 1.0,
    "km": 1e3,
    "uin": 2.54e-8,
    "mil": 2.54e-5,
    "in": 2.54e-2,
    "ft": 0.3048,
    "us-ft": 1200.0 / 3937.0,
    "yd": 0.9144,
    "mi": 1609.344,
}
SYNONYMS = {
    "nm": ("nanometre", "nanometer"),
    "um": ("µm", "μm", "micron", "micrometre", "micrometer"),
    "mm": ("millimetre", "millimeter", "millimetres", "millimeters"),
    "cm": ("centimetre", "centimeter", "centimetres", "centimeters"),
    "dm": ("decimetre", "decimeter"),
    "m": ("metre", "meter", "metres", "meters"),
    "km": ("kilometre", "kilometer"),
    "uin": ("microinch",),
    "in": ("inch", "inches", '"'),
    "ft": ("foot", "feet", "international foot"),
    "us-ft": ("us survey foot", "ftus"),
    "yd": ("yard",),
    "mi": ("mile",),
}
NAMES = {**{x: x for x in METRES}, **{x: unit for unit, every in SYNONYMS.items() for x in every}}


def unit_named(name: str) -> str | None:
    """Return the unit, a key of METRES, for any of its names; None if the name is unknown."""
    return NAMES.get(name.strip().lower())


def checked_unit(unit: object) -> str:
    """Return the unit, a key of METRES, for any of its names; InputError if the name is unknown."""
    known = unit_named(unit) if isinstance(unit, str) else None
    if known is None:
        raise InputError(f"unit must be one of {', '.join(METRES)}, not {shown(unit)}.")
    return known


def whole_of(samples: Samples) -> Whole | None:
    """Return the part on which samples lie, or from which they were moved; None without a part."""
    base = samples.offset_of
    surface = samples.surface if base is None else base.surface
    return surface if isinstance(surface, Whole) else None


def units_of(samples: Samples) -> dict[str, str]:
    """Return the units of fields by name, with the unit of length in place of L if it is known."""
    unit = samples.report.unit
    return {name: x if unit is None else x.replace("L", unit) for name, x in UNITS.items()}


def names_with_units(samples: Samples) -> list[str]:
    """Return the names of columns, with the unit in names of lengths and curvatures, if known."""
    units, known = units_of(samples), samples.report.unit is not None
    return [
        f"{column} [{units[name]}]" if known and "L" in UNITS.get(name, "") else column
        for name in samples.arrays()
        for column in COLUMNS[name]
    ]
