"""The part of docs/gallery/cad.py: a bracket made with Open CASCADE, as a STEP and an .npz file.

`python -m gaussmap.docs.bracket` writes them, where the extra `cad` is installed.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gaussmap as gm
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

__all__ = ["bracket", "write"]

GALLERY = Path(__file__).parent / "gallery"
# The centres of the edges that get fillets, and the radii, in mm.
FILLETS = {
    (8, 20, 8): 9.0,
    (8, 20, 35): 3.0,
    (13, 20, 35): 1.5,
    (60, 0, 4): 6.0,
    (60, 40, 4): 6.0,
}
STEEL, BRASS = (0.62, 0.68, 0.75), (0.85, 0.60, 0.20)  # red, green, blue
MACHINED = (3.5, 8.0)  # radii of the holes and the bore, which are of brass
# The header of a STEP file has the time at which it was written.
TIME = re.compile(rb"'\d{4}-\d\d-\d\dT[\d:+-]*'")


def bracket() -> Any:  # noqa: ANN401
    """Return a bracket in mm: a base with countersunk holes, a wall with a boss and a bore."""
    x, z = gp_Dir(1, 0, 0), gp_Dir(0, 0, 1)
    shape = box(60, 40, 8)
    for more in (box(8, 40, 35), rod(0, 20, 35, x, 20, 8), rod(8, 20, 35, x, 13, 5)):
        shape = BRepAlgoAPI_Fuse(shape, more).Shape()
    shape = BRepAlgoAPI_Cut(with_fillets(shape), rod(-1, 20, 35, x, 8, 20)).Shape()
    for y in (8, 32):
        for less in (rod(46, y, -1, z, 3.5, 10), rod(46, y, 4.5, z, 3.5, 7, 3.5)):
            shape = BRepAlgoAPI_Cut(shape, less).Shape()
    return shape


def box(*sizes: float) -> Any:  # noqa: ANN401
    """Return a box with a corner at the origin."""
    return BRepPrimAPI_MakeBox(*sizes).Shape()


def rod(x: float, y: float, z: float, along: gp_Dir, *size: float) -> Any:  # noqa: ANN401
    """Return a cylinder (radius, height), or a cone (two radii, height), that begins at a point."""
    make = BRepPrimAPI_MakeCylinder if len(size) == 2 else BRepPrimAPI_MakeCone
    return make(gp_Ax2(gp_Pnt(x, y, z), along), *size).Shape()


def with_fillets(shape: Any) -> Any:  # noqa: ANN401
    """Return a solid whose coplanar faces are joined, with the fillets of FILLETS."""
    whole = ShapeUpgrade_UnifySameDomain(shape)
    whole.Build()
    fillets = BRepFilletAPI_MakeFillet(whole.Shape())
    for edge in each(whole.Shape(), TopAbs_ShapeEnum.TopAbs_EDGE):
        line = GProp_GProps()
        BRepGProp.LinearProperties_s(edge, line)
        centre = line.CentreOfMass()
        radius = FILLETS.get((round(centre.X()), round(centre.Y()), round(centre.Z())))
        if radius is not None:
            fillets.Add(radius, TopoDS.Edge(edge))
    return fillets.Shape()


def each(shape: Any, kind: TopAbs_ShapeEnum) -> Iterator[Any]:  # noqa: ANN401
    """Yield the parts of one kind of a shape."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def write(path: Path) -> None:
    """Write the bracket to a STEP file, with a name, and colours for its bore and its holes."""
    document = TDocStd_Document(TCollection_ExtendedString("part"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1e-3)
    shape = bracket()
    label = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).AddShape(shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString("bracket"))
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    colors.SetColor(label, color(STEEL), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    for face in each(shape, TopAbs_ShapeEnum.TopAbs_FACE):
        if is_machined(TopoDS.Face(face)):
            colors.SetColor(face, color(BRASS), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    STEPCAFControl_Writer().Perform(document, str(path))
    path.write_bytes(TIME.sub(b"'2026-01-01T00:00:00'", path.read_bytes()))


def is_machined(face: Any) -> bool:  # noqa: ANN401
    """Say whether a face is one of the bore and of the holes with their countersinks."""
    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType().name
    if kind.endswith("_Cone"):
        return True
    return kind.endswith("_Cylinder") and surface.Cylinder().Radius() in MACHINED


def color(values: tuple[float, float, float]) -> Quantity_Color:
    """Return a colour of Open CASCADE."""
    return Quantity_Color(*values, Quantity_TypeOfColor.Quantity_TOC_sRGB)


if __name__ == "__main__":
    write(GALLERY / "bracket.step")
    gm.read_cad(GALLERY / "bracket.step").save(GALLERY / "bracket.npz")
