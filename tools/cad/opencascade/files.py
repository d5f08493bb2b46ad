"""Reading STEP, IGES and BREP files with Open CASCADE."""

# pyright: reportMissingImports=false

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TopoDS import TopoDS_Shape

from ...files.lengths import METRES, unit_named
from ...files.reading import UnusableError
from ..damaged_step import LostFace, numbers_of_entities
from ..source import Source
from .documents import Document, PlacedShape, new_document, pieces_of
from .shapes import sequence

# An entity is unusable if a message of Open CASCADE's checks contains one of these texts.
UNRESOLVED = "unresolved"
DAMAGE = ("not a real", UNRESOLVED)


def read_file(source: Source) -> tuple[Document, tuple[LostFace, ...]]:
    """Return the document in a file, in millimetres, and the faces that were left out.

    Raises UnusableError with the reason if the file cannot be read.
    """
    if source.format == "STEP":
        return _step(source)
    read = _iges if source.format == "IGES" else _brep
    return read(source.path), ()


def _step(source: Source) -> tuple[Document, tuple[LostFace, ...]]:
    reader = _read_step(source.path)
    damaged = _damaged(reader, source.content)
    repaired = None if damaged is None else source.without(damaged)
    if repaired is not None:
        source, reader = repaired, _read_step(repaired.path)
    document = new_document()
    reader.Transfer(document)
    found = pieces_of(document)
    _set_unit(found, reader.ChangeReader())
    return found, source.lost


def _read_step(path: Path) -> Any:  # noqa: ANN401
    return _read_by(STEPCAFControl_Reader(), path)


def _read_by(reader: Any, path: Path) -> Any:  # noqa: ANN401
    """Read a file into `reader`, with names and colours, and return `reader`.

    Raises UnusableError if Open CASCADE cannot read the file.
    """
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.SetLayerMode(False)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise UnusableError("is damaged: Open CASCADE cannot read it; export it again.")
    return reader


def _damaged(reader: Any, content: bytes) -> Mapping[int, str] | None:  # noqa: ANN401
    """Return the reasons why Open CASCADE calls entities damaged, by entity number.

    None means that it calls no entity damaged.
    """
    found: dict[int, str] = {}
    checks = reader.ChangeReader().WS().ModelCheckList()
    if checks.IsEmpty(True):
        return None
    checks.Start()
    while checks.More():
        check = checks.Value()
        texts = [check.CFail(k) for k in range(1, check.NbFails() + 1)]
        bad = [x for x in texts if any(word in x.lower() for word in DAMAGE)]
        if bad:
            found[checks.Number()] = bad[0]
        checks.Next()
    if not found:
        return None
    numbers = numbers_of_entities(content)
    if len(numbers) != reader.ChangeReader().StepModel().NbEntities():
        return {}  # missing entities are found without Open CASCADE
    return {
        numbers[k - 1]: f"its #{numbers[k - 1]} is damaged ({text})"
        for k, text in found.items()
        if k > 0 and UNRESOLVED not in text.lower()
    }


def _set_unit(document: Document, reader: Any) -> None:  # noqa: ANN401
    """Set the unit of a STEP file, which may have several units."""
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
        raise UnusableError("is damaged or truncated: Open CASCADE cannot read it; save it again.")
    return Document([PlacedShape(shape)])
