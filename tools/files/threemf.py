"""Triangles for 3-D printers: .3mf, a zip archive of XML (3MF core specification 1.3)."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from .lengths import METRES

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh

# trimesh is not used: it needs two more libraries, and writes different bytes each time.
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
TYPES = f"""{HEAD}<Types xmlns="{PACKAGE}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="{MODEL}"/>
</Types>
"""
RELATIONS = f"""{HEAD}<Relationships xmlns="{PACKAGE}/relationships">
<Relationship Id="rel0" Target="/3D/3dmodel.model" \
Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""
# The names of units in the format, by their names in gaussmap. Lengths in other units are written
# in millimetres.
UNITS = {
    "um": "micron", "mm": "millimeter", "cm": "centimeter", "m": "meter",
    "in": "inch", "ft": "foot",
}  # fmt: skip
# Entries of a zip archive have a time, from 1980 on. It is fixed, so that equal meshes make equal
# files.
TIME = (1980, 1, 1, 0, 0, 0)


def write_3mf(mesh: Mesh, path: Path) -> None:
    """Write vertices and triangles; an unknown unit of length is taken to be a millimetre.

    Triangles with a repeated vertex are left out, since the format forbids them.
    """
    contents = {
        "[Content_Types].xml": TYPES,
        "_rels/.rels": RELATIONS,
        "3D/3dmodel.model": "".join(_model(mesh)),
    }
    with zipfile.ZipFile(path, "w") as file:
        for name, text in contents.items():
            entry = zipfile.ZipInfo(name, TIME)
            file.writestr(entry, text, zipfile.ZIP_DEFLATED)


def _model(mesh: Mesh) -> Iterable[str]:
    """Yield the lines of 3D/3dmodel.model, the XML file with the mesh."""
    unit = mesh.unit if mesh.unit in UNITS else "mm"
    factor = METRES.get(mesh.unit, METRES[unit]) / METRES[unit]
    yield f'{HEAD}<model unit="{UNITS[unit]}" xml:lang="en-US" xmlns="{CORE}">\n<resources>\n'
    yield '<object id="1" type="model">\n<mesh>\n<vertices>\n'
    for x, y, z in (mesh.vertices * factor).tolist():
        yield f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n'
    yield "</vertices>\n<triangles>\n"
    a, b, c = mesh.triangles.T
    for i, j, k in mesh.triangles[(a != b) & (b != c) & (c != a)].tolist():
        yield f'<triangle v1="{i}" v2="{j}" v3="{k}"/>\n'
    yield "</triangles>\n</mesh>\n</object>\n</resources>\n"
    yield '<build>\n<item objectid="1"/>\n</build>\n</model>\n'
