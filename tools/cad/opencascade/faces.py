"""A face of Open CASCADE as a record: geometry, trim and area."""

# pyright: reportMissingImports=false

from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopoDS import TopoDS

from ..records import NO_AREA, FaceRecord, Geometry
from .curves import UnusableError
from .loops import EdgeCurves, loops_of, wires_of
from .shapes import Key
from .solids import CLOSE
from .surfaces import basis_of, geometry_of, periods_of

Array = NDArray[np.float64]

# The smallest area, in mm², that counts as positive: Open CASCADE considers points within 1e-7 mm
# equal.
LEAST_AREA = 1e-12
# The estimated relative error at which Open CASCADE stops dividing a face. With it, areas agree
# with closed forms to 1e-6; without it, areas of ellipsoids of one face are off by 3e-3.
PRECISION = 1e-10


class FaceReader:
    """Converts faces to records; trim and area of copies of a face are computed once.

    `gaps` are the largest gaps between consecutive edges of faces, in mm: one for each face with a
    gap wider than `CLOSE`.
    """

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self._known: dict[Key, tuple[list[Array], float]] = {}
        self._wires: dict[Key, EdgeCurves] = {}

    def wires(self, face: Any) -> EdgeCurves:  # noqa: ANN401
        """Return the edges of each wire of a face, in order, with their p-curves."""
        key = Key(face)
        if key not in self._wires:
            self._wires[key] = wires_of(_forward(face))
        return self._wires[key]

    def record(self, face: Any) -> FaceRecord:  # noqa: ANN401
        """Return the record of a face, with a reason if it has failed."""
        try:
            return self._record(face)
        except UnusableError as error:
            reason = str(error)
        except MemoryError:
            raise
        except Exception as error:  # Open CASCADE raises hundreds of exception types
            text = " ".join(str(error).split())[:80].rstrip(".")
            reason = f"Open CASCADE fails on it ({text or type(error).__name__})"
        return FaceRecord(Geometry("unknown"), reason=reason)

    def _record(self, face: Any) -> FaceRecord:  # noqa: ANN401
        surface = BRep_Tool.Surface_s(face)
        if surface is None:
            raise UnusableError("it has no surface")
        surface = basis_of(surface)
        loops, area = self._trim(face)
        points = np.concatenate(loops)
        (u0, v0), (u1, v1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        domain = (u0, u1), (v0, v1)
        return FaceRecord(
            geometry_of(surface, domain),
            domain,
            periods_of(surface),
            loops,
            face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED,
            area,
        )

    def _trim(self, face: Any) -> tuple[list[Array], float]:  # noqa: ANN401
        key = Key(face, placed=False)
        known = self._known.get(key)
        if known is None:
            loops, gap = loops_of(_forward(face), self.wires)
            known = loops, area_of(face)
            if not np.isfinite(known[1]):
                raise UnusableError("its area is not finite")
            if known[1] < LEAST_AREA:
                raise UnusableError(NO_AREA)
            self._known[key] = known
            self.gaps += [gap] if gap > CLOSE else []
        return known


def _forward(face: Any) -> Any:  # noqa: ANN401
    return TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))


def area_of(face: Any) -> float:  # noqa: ANN401
    """Return the area of a face, in mm², with a relative error of about 1e-6."""
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties, PRECISION, False)
    return float(properties.Mass())
