"""Files in VTK's formats, by VTK itself: PolyData and unstructured grids, in XML."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...runtime.base.extras import from_extra
from ...runtime.samples.samples import Samples
from .content import report_to_json
from .of_samples import polydata, to_pyvista

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh


def write_vtp(samples: Samples, path: Path) -> None:
    """Write points with all other fields, and the report as field data."""
    data = to_pyvista(samples)
    data.field_data["report"] = [report_to_json(samples.report)]
    _write_xml("vtkXMLPolyDataWriter", data, path)


def write_mesh_vtp(mesh: Mesh, path: Path) -> None:
    """Write triangles, with normals, uv and sample_index of their vertices."""
    _write_xml("vtkXMLPolyDataWriter", mesh.to_pyvista(), path)


def write_vtu(mesh: Mesh, path: Path) -> None:
    """Write an unstructured grid, with normals, u, v and sample_index of the vertices."""
    pv = from_extra("pyvista", "vtk", "a file of VTK")
    u, v = np.ascontiguousarray(mesh.uv.T)
    cells = {pv.CellType.TRIANGLE: mesh.triangles}
    arrays = {"normals": mesh.normals, "sample_index": mesh.sample_index, "u": u, "v": v}
    grid = polydata(pv, pv.UnstructuredGrid(cells, mesh.vertices), arrays)
    _write_xml("vtkXMLUnstructuredGridWriter", grid, path)


def _write_xml(name: str, data: Any, path: Path) -> None:  # noqa: ANN401
    """Write a file by way of memory, since a writer of VTK only prints errors about files."""
    writer = getattr(import_module("vtkmodules.vtkIOXML"), name)()
    writer.SetDataModeToBinary()
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()
    writer.Write()
    path.write_text(writer.GetOutputString(), encoding="ascii")
