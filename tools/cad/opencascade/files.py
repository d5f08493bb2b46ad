"""Reading STEP, IGES and BREP files with Open CASCADE."""

# pyright: reportMissingImports=false

from __future__ import annotations

from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TopoDS import TopoDS_Shape

from ...files.lengths import METRES, unit_named
from ..inspection import BadFileError
from .documents import Document, PlacedShape, new_document, pieces_of
from .shapes import sequence

__all__ = ["read_file"]

# Of what Open CASCADE says of the entities of a file, in small letters, what makes faces wrong.
NO_NUMBER, UNRESOLVED = "not a real", "unresolved"


def read_file(path: Path, form: str) -> Document:
    """Return what a file holds, in millimetres; BadFileError says why it cannot be read."""
    return {"STEP": _step, "IGES": _iges, "BREP": _brep}[form](path)


def _step(path: Path) -> Document:
    reader = _read_by(STEPCAFControl_Reader(), path)
    unresolved = _has_unresolved(reader.ChangeReader())
    document = new_document()
    reader.Transfer(document)
    found = pieces_of(document)
    _set_unit(found, reader.ChangeReader())
    if unresolved:
        found.warnings.append(
            "it refers to what it lacks: faces may be missing, or lack holes; export it again."
        )
    return found


def _read_by(reader: Any, path: Path) -> Any:  # noqa: ANN401
    """Return the reader, with names and colours of the file; BadFileError if it cannot read it."""
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.SetLayerMode(False)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise BadFileError("is damaged: Open CASCADE cannot read it; export it again.")
    return reader


def _has_unresolved(reader: Any) -> bool:  # noqa: ANN401
    """Say whether entities refer to others that the file lacks.

    BadFileError for a text in place of a number: Open CASCADE would take 0.
    """
    texts, checks = [], reader.WS().ModelCheckList()
    checks.Start()
    while checks.More():
        check = checks.Value()
        texts += [check.CFail(k) for k in range(1, check.NbFails() + 1)]
        checks.Next()
    bad = next((x for x in texts if NO_NUMBER in x.lower()), None)
    if bad is not None:
        raise BadFileError(f"is damaged: {bad.strip()}; export it again.")
    return any(UNRESOLVED in x.lower() for x in texts)


def _set_unit(document: Document, reader: Any) -> None:  # noqa: ANN401
    """Find the unit of a STEP file: it may have several."""
    names = [sequence("TColStd.TColStd_SequenceOfAsciiString", "Sequence_TCollection_AsciiString")]
    names += [type(names[0])(), type(names[0])()]
    reader.FileUnits(*names)
    found = [names[0].Value(k).ToCString() for k in range(1, names[0].Length() + 1)]
    units = list(dict.fromkeys(unit_named(x) or x for x in found if x.strip()))
    known = [x for x in units if x in METRES]
    document.unit = known[0] if known else "mm"
    if len(units) > 1:
        document.warnings.append(
            f"its lengths are in several units ({', '.join(units)}); "
            f"all are in {document.unit} now."
        )
    elif len(known) < len(units):
        document.warnings.append(
            f"its unit of length, {units[0]!r}, is not known; lengths are in mm."
        )


def _iges(path: Path) -> Document:
    reader = _read_by(IGESCAFControl_Reader(), path)
    metres = reader.IGESModel().GlobalSection().UnitValue() / 1e3
    document = new_document()
    reader.Transfer(document)
    found = pieces_of(document)
    close = [x for x, length in METRES.items() if abs(metres / length - 1.0) < 1e-6]
    if close:
        found.unit = close[0]
    else:
        found.warnings.append(f"its unit of length is {metres:g} m; lengths are in mm.")
    return found


def _brep(path: Path) -> Document:
    shape = TopoDS_Shape()
    if not BRepTools.Read_s(shape, str(path), BRep_Builder()) or shape.IsNull():
        raise BadFileError("is damaged or truncated: Open CASCADE cannot read it; save it again.")
    return Document([PlacedShape(shape)])
