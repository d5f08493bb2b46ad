"""Converting records of faces to another unit of length."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .records import KINDS, FaceRecord, Geometry


def with_unit(face: FaceRecord, factor: float) -> FaceRecord:
    """Return a face with all lengths multiplied by `factor`, also parameters that are lengths."""
    if factor == 1.0:
        return face
    scale = scaled_parameters(face.geometry, factor)
    return replace(
        face,
        geometry=_scaled(face.geometry, factor),
        domain=(np.array(face.domain).T * scale).T.tolist() if face.loops else face.domain,
        periods=(np.array(face.periods) * scale).tolist(),
        loops=[loop * scale for loop in face.loops],
        area=face.area * factor**2,
    )


def scaled_parameters(geometry: Geometry, factor: float) -> NDArray[np.float64]:
    """Return the factors (2,) by which u and v change if lengths are multiplied by `factor`."""
    while geometry.basis is not None:
        geometry = geometry.basis
    kind = KINDS[geometry.kind]
    return np.where([x == "length" for x in (kind.u, kind.v)], factor, 1.0)


def _scaled(geometry: Geometry, factor: float) -> Geometry:
    numbers = np.array(geometry.numbers, dtype=np.float64)
    numbers[list(KINDS[geometry.kind].lengths)] *= factor
    net, basis = geometry.net, geometry.basis
    return Geometry(
        geometry.kind,
        numbers,
        None if net is None else replace(net, points=net.points * factor),
        None if basis is None else _scaled(basis, factor),
    )
