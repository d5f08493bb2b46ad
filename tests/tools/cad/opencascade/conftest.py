"""Small CAD files, made by Open CASCADE for the tests."""

# pyright: reportMissingImports=false

from pathlib import Path

import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.opencascade.parts import part_record
from gaussmap.tools.cad.part import part_of
from gaussmap.tools.cad.source import prepared
from OCP.BRepTools import BRepTools
from OCP.IGESControl import IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer


def written(shape, path: Path, unit: str = "MM") -> Path:
    """Write a shape to a STEP, IGES or BREP file."""
    if path.suffix == ".iges":
        writer = IGESControl_Writer(unit, 1)
        writer.AddShape(shape)
        writer.ComputeModel()
        writer.Write(str(path))
        return path
    if path.suffix == ".brep":
        BRepTools.Write_s(shape, str(path))
        return path
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path


@pytest.fixture
def write(tmp_path, capfd):
    """Write a shape to a file of the test; the writer prints."""

    def write(shape, name: str = "part.step", unit: str = "MM") -> Path:
        return written(shape, tmp_path / name, unit)

    yield write
    capfd.readouterr()


@pytest.fixture
def read(tmp_path):
    """Read a file in this process, as the reader's process does."""

    def read(path: Path, unit: str | None = None):
        return part_record(prepared(path, tmp_path), path.name, unit)

    return read


@pytest.fixture
def part_with(write, read):
    """Make the part of a shape."""
    return lambda shape, unit=None: part_of(read(write(shape, "part.brep"), unit))
