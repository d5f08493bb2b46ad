"""Units of length, and their names in files."""

from __future__ import annotations

__all__ = ["METRES", "unit_named"]

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
    """Return the unit that a file or a user calls so; None if there is no such unit."""
    return NAMES.get(name.strip().lower())
