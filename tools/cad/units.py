"""Units of length: their names in files, and records in another unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .records import FaceRecord, Geometry

__all__ = ["METRES", "unit_named", "with_unit"]

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
    "ft": ("foot", "feet"),
    "yd": ("yard",),
    "mi": ("mile",),
}
NAMES = {**{x: x for x in METRES}, **{x: unit for unit, every in SYNONYMS.items() for x in every}}

# Where the numbers of a kind are lengths, and which parameters.
LENGTHS: dict[str, tuple[tuple[int, ...], tuple[bool, bool]]] = {
    "plane": ((0, 1, 2), (True, True)),
    "cylinder": ((0, 1, 2, 12), (False, True)),
    "cone": ((0, 1, 2, 12), (False, True)),
    "sphere": ((0, 1, 2, 12), (False, False)),
    "torus": ((0, 1, 2, 12, 13), (False, False)),
    "nurbs": ((), (False, False)),
    "revolution": ((0, 1, 2), (False, False)),
    "extrusion": ((), (False, True)),
    "offset": ((0,), (False, False)),
    "unknown": ((), (False, False)),
}


def unit_named(name: str) -> str | None:
    """Return the unit that a file or a user calls so; None if there is no such unit."""
    return NAMES.get(name.strip().lower())


def with_unit(face: FaceRecord, factor: float) -> FaceRecord:
    """Return a face whose lengths are multiplied, and its parameters where they are lengths."""
    if factor == 1.0:
        return face
    scale = _of_parameters(face.geometry, factor)
    return replace(
        face,
        geometry=_scaled(face.geometry, factor),
        domain=(np.array(face.domain).T * scale).T.tolist() if face.loops else face.domain,
        periods=(np.array(face.periods) * scale).tolist(),
        loops=[loop * scale for loop in face.loops],
        area=face.area * factor**2,
    )


def scaled_parameters(geometry: Geometry, factor: float) -> Sequence[float]:
    """Return what u and v of a surface are multiplied with if lengths are with a factor."""
    return _of_parameters(geometry, factor).tolist()


def _of_parameters(geometry: Geometry, factor: float) -> np.ndarray:
    while geometry.basis is not None:
        geometry = geometry.basis
    return np.where(LENGTHS[geometry.kind][1], factor, 1.0)


def _scaled(geometry: Geometry, factor: float) -> Geometry:
    numbers, places = np.array(geometry.numbers, dtype=np.float64), LENGTHS[geometry.kind][0]
    numbers[list(places)] *= factor
    net, basis = geometry.net, geometry.basis
    return Geometry(
        geometry.kind,
        numbers,
        None if net is None else replace(net, points=net.points * factor),
        None if basis is None else _scaled(basis, factor),
    )
