"""The faces of solids and loose faces, oriented: normals point out of the enclosed solid."""

# pyright: reportMissingImports=false

from dataclasses import dataclass, field
from typing import Any

from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepLib import BRepLib
from OCP.gp import gp_Pnt
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TopAbs import TopAbs_ShapeEnum as Kinds
from OCP.TopAbs import TopAbs_State
from OCP.TopoDS import TopoDS, TopoDS_Compound

from .documents import Color, Document, Style
from .shapes import Key, parts_of

# Loose faces are sewn where their boundaries are closer than CLOSE, in mm; if holes remain, closer
# than CLOSE_OF_SIZE, relative to the size of all faces.
CLOSE, CLOSE_OF_SIZE = 1e-3, 1e-4
# The largest number of loose faces that are sewn: more of them would take minutes.
MOST_LOOSE = 20_000


@dataclass(frozen=True)
class PlacedFace:
    """A placed, oriented face; `sewn` is its copy that shares edges with its neighbours."""

    shape: Any
    sewn: Any
    solid: int
    name: str
    color: Color | None


@dataclass
class Gathered:
    """All faces; `closed` says whether each of them belongs to a closed solid."""

    faces: list[PlacedFace] = field(default_factory=list)
    solid_names: list[str] = field(default_factory=list)
    closed: bool = True


def gathered(document: Document) -> Gathered:
    """Return all faces of a document: faces of solids first, then loose faces."""
    found, loose = Gathered(), []
    for piece in document.pieces:
        for solid in parts_of(piece.shape, Kinds.TopAbs_SOLID):
            _add_solid(found, TopoDS.Solid(solid), piece.name, piece.color, document.styles)
        for face in parts_of(piece.shape, Kinds.TopAbs_FACE, Kinds.TopAbs_SOLID):
            style = _style(document.styles, face, Style(color=piece.color))
            single = piece.shape.ShapeType() == Kinds.TopAbs_FACE
            loose.append((face, Style(style.name or (piece.name if single else ""), style.color)))
    if loose:
        _add_loose(found, loose)
    return found


def _add_solid(
    found: Gathered,
    solid: Any,  # noqa: ANN401
    name: str,
    color: Color | None,
    styles: dict[Key, Style],
) -> None:
    closed = all(BRep_Tool.IsClosed_s(x) for x in parts_of(solid, Kinds.TopAbs_SHELL))
    if closed:
        BRepLib.OrientClosedSolid_s(solid)
    found.closed &= closed
    own = styles.get(Key(solid, placed=False)) or Style()
    style = Style(own.name or name, own.color or color)
    number = len(found.solid_names)
    found.solid_names.append(style.name)
    for face in parts_of(solid, Kinds.TopAbs_FACE):
        of_face = _style(styles, face, Style(color=style.color))
        found.faces.append(PlacedFace(face, face, number, of_face.name, of_face.color))


def _style(styles: dict[Key, Style], face: Any, default: Style) -> Style:  # noqa: ANN401
    own = styles.get(Key(face, placed=False))
    return default if own is None else Style(own.name, own.color or default.color)


# --- loose faces ----------------------------------------------------------------------------------


def _add_loose(found: Gathered, loose: list[tuple[Any, Style]]) -> None:
    sewing = _sewn([face for face, _ in loose]) if len(loose) <= MOST_LOOSE else None
    oriented: dict[Key, tuple[Any, int]] = {}
    if sewing is not None:
        closed = _closed_solids(sewing.SewedShape())
        for number, solid in enumerate(closed, len(found.solid_names)):
            for face in parts_of(solid, Kinds.TopAbs_FACE):
                oriented.setdefault(Key(face), (face, number))
        found.solid_names.extend([""] * len(closed))
        for face in parts_of(sewing.SewedShape(), Kinds.TopAbs_FACE):
            oriented.setdefault(Key(face), (face, -1))  # unless the face is part of a solid
    for face, style in loose:
        known = None
        if sewing is not None:
            known = oriented.get(Key(sewing.Modified(face) if sewing.IsModified(face) else face))
        copy, number = known or (face, -1)
        found.closed &= number >= 0
        shape = face.Oriented(copy.Orientation())
        found.faces.append(PlacedFace(shape, copy, number, style.name, style.color))


def _sewn(faces: list[Any]) -> Any:  # noqa: ANN401
    """Return the sewing of faces, with a wider tolerance if the narrow tolerance leaves holes."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for face in faces:
        builder.Add(compound, face)
    sewing = None
    for tolerance in (CLOSE, max(CLOSE, CLOSE_OF_SIZE * _size(compound))):
        sewing = BRepBuilderAPI_Sewing(tolerance)
        for face in faces:
            sewing.Add(face)
        sewing.Perform()
        if sewing.NbFreeEdges() == 0:
            break
    return sewing


def _size(shape: Any) -> float:  # noqa: ANN401
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    return 0.0 if box.IsVoid() or box.IsOpen() else box.SquareExtent() ** 0.5


def _closed_solids(sewn: Any) -> list[Any]:  # noqa: ANN401
    """Return the closed shells as solids.

    Normals point outward; those of a shell that bounds a cavity point into the cavity.
    """
    shells = [TopoDS.Shell(x) for x in parts_of(sewn, Kinds.TopAbs_SHELL)]
    solids = []
    for shell in shells:
        if BRep_Tool.IsClosed_s(shell):
            solid = ShapeFix_Solid().SolidFromShell(shell)
            BRepLib.OrientClosedSolid_s(solid)
            solids.append(solid)
    return [x.Reversed() if _is_hollow(x, solids) else x for x in solids]


def _is_hollow(solid: Any, solids: list[Any]) -> bool:  # noqa: ANN401
    """Return whether a shell bounds a cavity: it lies inside an odd number of other shells."""
    vertex = next(parts_of(solid, Kinds.TopAbs_VERTEX), None)
    if vertex is None or len(solids) == 1:
        return False
    point: gp_Pnt = BRep_Tool.Pnt_s(TopoDS.Vertex(vertex))
    around = [
        other
        for other in solids
        if other is not solid
        and BRepClass3d_SolidClassifier(other, point, 1e-7).State() == TopAbs_State.TopAbs_IN
    ]
    return len(around) % 2 == 1
