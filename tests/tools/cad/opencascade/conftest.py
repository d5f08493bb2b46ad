"""Small CAD files, made by Open CASCADE for the tests."""

# pyright: reportMissingImports=false

from pathlib import Path

import numpy as np
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


def points_of(geometry, uv: np.ndarray) -> np.ndarray:
    """Return the points of a surface by the formulas that `saving` gives."""
    from scipy.interpolate import BSpline, NdBSpline

    (u, v), n = uv.T, geometry.numbers
    across = v[:, None]
    if geometry.net is not None:
        net = geometry.net
        weights = np.ones(net.points.shape[:-1]) if net.weights is None else net.weights
        lifted = np.concatenate([net.points * weights[..., None], weights[..., None]], axis=-1)
        if geometry.kind == "nurbs":
            found = NdBSpline(net.knots, lifted, net.degrees)(uv)
        else:
            spline = BSpline(net.knots[0], lifted, net.degrees[0])
            found = spline(v if geometry.kind == "revolution" else u)
        curve = found[:, :3] / found[:, 3:]
        if geometry.kind == "nurbs":
            return curve
        if geometry.kind == "extrusion":
            return curve + across * n
        origin, axis = n[:3], n[3:]
        arm, c, s = curve - origin, np.cos(u)[:, None], np.sin(u)[:, None]
        along = (1.0 - c) * (arm @ axis)[:, None] * axis
        return origin + c * arm + s * np.cross(axis, arm) + along
    o, x, y, z = n[:12].reshape(4, 3)
    out = np.outer(np.cos(u), x) + np.outer(np.sin(u), y)
    if geometry.kind == "plane":
        return o + np.outer(u, x) + np.outer(v, y)
    if geometry.kind == "cylinder":
        return o + n[12] * out + across * z
    if geometry.kind == "cone":
        return o + (n[12] + across * np.sin(n[13])) * out + across * np.cos(n[13]) * z
    if geometry.kind == "sphere":
        return o + n[12] * (np.cos(across) * out + np.sin(across) * z)
    assert geometry.kind == "torus"
    return o + (n[12] + n[13] * np.cos(across)) * out + n[13] * np.sin(across) * z
