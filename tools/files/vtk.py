"""Files of VTK: PolyData and unstructured grids in XML (raw, appended), and the older format.

They are written here because VTK takes half a gigabyte, and its writers thirty times as long:
numbers stand in these files as they stand in memory. The names in them need no escapes.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.samples.samples import Samples
from .content import report_to_json

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh

__all__ = ["write_mesh_vtp", "write_vtk", "write_vtp", "write_vtu"]

_OLD_NAMES = {"float64": "double", "int64": "vtktypeint64"}
_TRIANGLE = 5

Arrays = dict[str, NDArray[Any]]


def write_vtp(samples: Samples, path: Path) -> None:
    """Write points with all other fields, and the report as field data."""
    data, text = samples.arrays(), report_to_json(samples.report)
    data = {x: y.view(np.uint8) if y.dtype == np.bool_ else y for x, y in data.items()}
    alone = np.arange(len(samples))[:, None]
    _write_xml(path, "PolyData", data.pop("points"), {"Verts": _topology(alone)}, data, text)


def write_mesh_vtp(mesh: Mesh, path: Path) -> None:
    """Write triangles, with normals, uv and sample_index of their vertices."""
    data = {"normals": mesh.normals, "uv": mesh.uv, "sample_index": mesh.sample_index}
    _write_xml(path, "PolyData", mesh.vertices, {"Polys": _topology(mesh.triangles)}, data)


def write_vtu(mesh: Mesh, path: Path) -> None:
    """Write an unstructured grid, with normals, u, v and sample_index of the vertices."""
    types = np.full(len(mesh.triangles), _TRIANGLE, np.uint8)
    cells = {"Cells": _topology(mesh.triangles) | {"types": types}}
    _write_xml(path, "UnstructuredGrid", mesh.vertices, cells, _vertex_data(mesh))


def write_vtk(mesh: Mesh, path: Path) -> None:
    """Write the grid of a .vtu file in the older format, version 5.1."""
    count, size, data = len(mesh.triangles), mesh.triangles.size, _vertex_data(mesh)
    lines: Arrays = {
        "# vtk DataFile Version 5.1\nwritten by gaussmap\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {len(mesh.vertices)} double": mesh.vertices,
        f"CELLS {count + 1} {size}\nOFFSETS vtktypeint64": np.arange(0, size + 1, 3),
        "CONNECTIVITY vtktypeint64": mesh.triangles,
        f"CELL_TYPES {count}": np.full(count, _TRIANGLE, np.int32),
        f"POINT_DATA {len(mesh.vertices)}\nFIELD FieldData {len(data)}": np.empty(0),
    }
    for name, array in data.items():
        lines[f"{name} {_width(array)} {len(array)} {_OLD_NAMES[array.dtype.name]}"] = array
    with open(path, "wb") as file:
        for line, array in lines.items():
            numbers = array.astype(array.dtype.newbyteorder(">")).tobytes()
            file.write(line.encode() + b"\n" + numbers + b"\n" * (array.size > 0))


def _vertex_data(mesh: Mesh) -> Arrays:
    u, v = mesh.uv.T
    return {"normals": mesh.normals, "sample_index": mesh.sample_index, "u": u, "v": v}


def _topology(cells: NDArray[np.int64]) -> Arrays:
    """Describe cells (k, n) that have n corners each."""
    return {"connectivity": cells.ravel(), "offsets": np.arange(1, len(cells) + 1) * cells.shape[1]}


def _width(array: NDArray[Any]) -> int:
    return array.shape[1] if array.ndim > 1 else 1


def _write_xml(
    path: Path,
    grid: str,
    points: NDArray[Any],
    cells: dict[str, Arrays],
    data: Arrays,
    report: str = "",
) -> None:
    """Write a grid of one piece; the report, of ASCII, as the codes of its letters."""
    ((kind, topology),) = cells.items()
    byte_order = f"{sys.byteorder.capitalize()}Endian"
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="{grid}" version="1.0" byte_order="{byte_order}" header_type="UInt64">',
        f"<{grid}>",
    ]
    if report:
        codes = " ".join(str(code) for code in (*report.encode("ascii"), 0))
        array = (
            f'Array type="String" Name="report" NumberOfTuples="1" format="ascii">{codes}</Array'
        )
        lines.append(f"<FieldData><{array}></FieldData>")
    lines.append(
        f'<Piece NumberOfPoints="{len(points)}" NumberOf{kind}="{len(topology["offsets"])}">'
    )
    blocks: list[NDArray[Any]] = []
    offset = 0
    for group, arrays in {"Points": {"points": points}, **cells, "PointData": data}.items():
        normals = ' Normals="normals"' if "normals" in arrays else ""
        lines.append(f"<{group}{normals}>")
        for name, array in arrays.items():
            size = f'type="{_type(array)}" NumberOfComponents="{_width(array)}"'
            place = f'format="appended" offset="{offset}"'
            lines.append(f'<DataArray Name="{name}" {size} {place}/>')
            blocks += [np.array([array.nbytes], np.uint64), np.ascontiguousarray(array)]
            offset += 8 + array.nbytes
        lines.append(f"</{group}>")
    lines += ["</Piece>", f"</{grid}>", '<AppendedData encoding="raw">', "_"]
    with open(path, "wb") as file:
        file.write("\n".join(lines).encode("ascii"))
        file.writelines(block.data for block in blocks)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def _type(array: NDArray[Any]) -> str:
    """Return VTK's name of a type: Float64 for float64, UInt8 for uint8."""
    return array.dtype.name.title().replace("Ui", "UI")
