"""A CAD file as the record of a part."""

# pyright: reportMissingImports=false

from collections.abc import Iterator
from dataclasses import replace

from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopAbs import TopAbs_ShapeEnum as Kinds
from OCP.TopoDS import TopoDS

from ....runtime.base.wording import plural
from ...files.lengths import METRES
from ...files.reading import UnusableError
from ..records import FaceRecord, Geometry, PartRecord
from ..source import Source
from ..units import with_unit
from .documents import Document
from .edges import topology_of
from .faces import FaceReader
from .files import read_file
from .shapes import Key, parts_of
from .solids import PlacedFace, gathered

# The largest number of invalid faces that a warning names.
MOST_NAMED = 5


def part_record(source: Source, name: str, unit: str | None) -> PartRecord:
    """Return the record of the part in a file, in the given unit or in the unit of the file.

    Raises UnusableError with the reason if the file cannot be used.
    """
    document, lost = read_file(source)
    found = gathered(document)
    said = source.faces_said()
    _warn_of_part_files(document, source)
    if not found.faces and not lost:
        if document.warnings and source.parts:
            raise UnusableError(f"has no faces that can be read: {document.warnings[-1]}")
        raise UnusableError(
            f"is damaged: Open CASCADE can make none of its {said} faces; export it again."
            if said
            else f"has no faces{_others(document)}; a part needs solids, shells or faces."
        )
    reader = FaceReader()
    faces = [_face(x, reader) for x in found.faces]
    if all(x.reason for x in faces):
        why = faces[0].reason if faces else lost[0].reason
        raise UnusableError(f"has no face that can be used: of the first one, {why}.")
    # Copies in several placements count as one face.
    missing = said - len({Key(x.shape, placed=False) for x in found.faces}) - len(lost)
    if missing > 0:
        document.warnings.append(
            f"{missing} of {said} faces are missing: Open CASCADE cannot make them; export the "
            "file again."
        )
    in_unit = unit or document.unit
    factor = METRES["mm"] / METRES[in_unit]
    if reader.gaps:
        document.warnings.append(
            f"consecutive edges of {plural(len(reader.gaps), 'face')} are up to "
            f"{max(reader.gaps) * factor:.2g} {in_unit} apart; samples there may be as far outside "
            "of the face."
        )
    document.warnings.extend(_invalid(document, found.faces))
    topology = topology_of(found.faces, faces, factor, reader)
    faces = [replace(x, wires=wires) for x, wires in zip(faces, topology.wires, strict=True)]
    return PartRecord(
        name,
        in_unit,
        METRES[in_unit],
        found.closed,
        [
            *(with_unit(x, factor) for x in faces),
            *(FaceRecord(Geometry("unknown"), name=x.name, reason=x.reason) for x in lost),
        ],
        found.solid_names,
        topology.edges,
        topology.vertices,
        document.warnings,
    )


def _invalid(document: Document, faces: list[PlacedFace]) -> Iterator[str]:
    """Yield a sentence about the faces, or their joins, that Open CASCADE calls invalid, if any."""
    if all(BRepCheck_Analyzer(x.shape).IsValid() for x in document.pieces):
        return
    bad = [k for k, x in enumerate(faces) if not BRepCheck_Analyzer(x.shape).IsValid()]
    named = ", ".join(map(str, bad[:MOST_NAMED])) + (", …" if len(bad) > MOST_NAMED else "")
    which = f"{plural(len(bad), 'face')} of it ({named})" if bad else "how its faces join"
    yield (
        f"Open CASCADE calls {which} invalid: results there may be wrong; repair it in a CAD "
        "program."
    )


def _warn_of_part_files(document: Document, source: Source) -> None:
    """Warn of part files that cannot be read.

    Open CASCADE makes an empty shape of each reference to such a file.
    """
    if source.parts is not None and (which := source.parts.said()):
        empty = plural(sum(x.shape.NbChildren() == 0 for x in document.pieces), "reference")
        document.warnings.append(f"{which}; left out: {empty} to them.")


def _others(document: Document) -> str:
    """Return a text about a file without faces: its numbers of edges, and of points on no edge."""
    every = [x.shape for x in document.pieces]
    edges = {Key(x) for y in every for x in parts_of(y, Kinds.TopAbs_EDGE)}
    points = {Key(x) for y in every for x in parts_of(y, Kinds.TopAbs_VERTEX, Kinds.TopAbs_EDGE)}
    counts = (edges, "edge"), (points, "point")
    said = ", ".join(plural(len(x), word) for x, word in counts if x)
    return f": {said}" if said else ""


def _face(face: PlacedFace, reader: FaceReader) -> FaceRecord:
    record = reader.record(TopoDS.Face(face.shape))
    return replace(record, name=face.name, color=face.color, solid_index=face.solid)
