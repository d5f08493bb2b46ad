"""The contents of a CAD file: shapes with their placements, names and colours."""

# pyright: reportMissingImports=false

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import (
    XCAFDoc_ColorTool,
    XCAFDoc_ColorType,
    XCAFDoc_DocumentTool,
    XCAFDoc_ShapeTool,
)

from .shapes import Key, sequence

Color = tuple[float, float, float]

MOST_LEVELS = 100
DIGITS = 6  # of colours


@dataclass(frozen=True)
class Style:
    """The name of a shape, "" if it has none, and its colour, None if it has none."""

    name: str = ""
    color: Color | None = None


@dataclass(frozen=True)
class PlacedShape:
    """A placed shape with its colour, and its name after the names of its assemblies."""

    shape: Any
    name: str = ""
    color: Color | None = None


@dataclass
class Document:
    """The placed shapes of a file.

    `styles` are the names and colours of subshapes, by shape without its placement.
    """

    pieces: list[PlacedShape]
    styles: dict[Key, Style] = field(default_factory=dict)
    unit: str = "mm"
    warnings: list[str] = field(default_factory=list)


def new_document() -> Any:  # noqa: ANN401
    """Return an empty document in millimetres, which a reader of STEP or IGES can fill."""
    document = TDocStd_Document(TCollection_ExtendedString("part"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1e-3)
    return document


def pieces_of(document: Any) -> Document:  # noqa: ANN401
    """Return the shapes, names and colours of a document that a reader has filled."""
    found = Document([])
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = _labels()
    tool.GetFreeShapes(labels)
    for label in _each(labels):
        found.pieces.extend(_walked(label, TopLoc_Location(), (), None, found.styles))
    return found


def _walked(
    label: Any,  # noqa: ANN401
    place: Any,  # noqa: ANN401
    names: tuple[str, ...],
    color: Color | None,
    styles: dict[Key, Style],
) -> Iterator[PlacedShape]:
    """Yield the shape of a label or, if the label is an assembly, the shapes of its components."""
    own_color = _color(label)
    if XCAFDoc_ShapeTool.IsReference_s(label):
        referred = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, referred)
        place = place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
        yield from _walked(referred, place, names, own_color or color, styles)
        return
    names = (*names, _name(label))
    color = own_color or color
    if XCAFDoc_ShapeTool.IsAssembly_s(label) and len(names) <= MOST_LEVELS:
        components = _labels()
        XCAFDoc_ShapeTool.GetComponents_s(label, components)
        for component in _each(components):
            yield from _walked(component, place, names, color, styles)
        return
    parts = _labels()
    XCAFDoc_ShapeTool.GetSubShapes_s(label, parts)
    for part in _each(parts):
        key = Key(XCAFDoc_ShapeTool.GetShape_s(part), placed=False)
        styles.setdefault(key, Style(_name(part), _color(part)))
    shape = XCAFDoc_ShapeTool.GetShape_s(label)
    if shape is not None and not shape.IsNull():
        yield PlacedShape(shape.Moved(place), "/".join(x for x in names if x), color)


def _labels() -> Any:  # noqa: ANN401
    return sequence("TDF.TDF_LabelSequence", "Sequence_TDF_Label")


def _each(labels: Any) -> Iterator[Any]:  # noqa: ANN401
    return (labels.Value(k) for k in range(1, labels.Length() + 1))


def _name(label: Any) -> str:  # noqa: ANN401
    if not label.IsAttribute(TDataStd_Name.GetID_s()):  # otherwise FindAttribute crashes
        return ""
    attribute = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), attribute)
    name = " ".join(attribute.Get().ToExtString().split())
    return "" if name.startswith("=>[") else name  # Open CASCADE's own names for components


def _color(label: Any) -> Color | None:  # noqa: ANN401
    color = Quantity_Color()
    for kind in (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, color):
            # These are the sRGB values of files. Open CASCADE itself stores linear values, in
            # single precision.
            red, green, blue = color.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)
            return round(red, DIGITS), round(green, DIGITS), round(blue, DIGITS)
    return None
