"""What large CAD parts cost: `python benchmarks/cad_sizes.py` prints the table of docs/cad.md.

Open CASCADE makes each part. It is read and sampled in a process of its own, once before for its
kernels. Names of parts are arguments; without, all but those that take long.
"""

# Its extra is not installed for developers.
# pyright: reportMissingImports=false

from __future__ import annotations

import itertools
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["PARTS", "write_nets", "write_plates"]

SAMPLES = 50_000
# Each boss has four faces: a fillet, a cylinder, a chamfer and the top. Lengths are in mm.
PITCH, THICK, COLUMNS = 10.0, 5.0, 25
PROFILE = ((3.5, 0.0), (2.5, 1.0), (2.5, 4.0), (2.0, 4.5), (0.0, 4.5))
NEAR = 1e-9
# NURBS faces are bicubic, and have waves of this height.
DEGREE, WAVE, WAVES = 3, 5.0, 2


def write_plates(path: Path, plates: int, bosses: int) -> None:
    """Write plates with some bosses in all, side by side: 6 · plates + 4 · bosses faces.

    A single plate would have thousands of holes in one face, whose wires Open CASCADE compares in
    pairs.
    """
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    ends = np.linspace(0, bosses, plates + 1).astype(int)
    for k, number in enumerate(np.diff(ends)):
        builder.Add(compound, _plate(int(number), k * (COLUMNS + 1) * PITCH))
    _write(path, compound)


def write_nets(path: Path, faces: int, points: int) -> None:
    """Write wavy bicubic faces of points × points control points, apart from one another."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.TopoDS import TopoDS_Compound

    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for k in range(faces):
        builder.Add(compound, BRepBuilderAPI_MakeFace(_net(points, k), 1e-6).Face())
    _write(path, compound)


def _write(path: Path, shape: Any) -> None:
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))


def _plate(bosses: int, left: float) -> Any:
    """Return a plate with bosses in rows, as one solid whose faces share their edges."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS, TopoDS_Shell, TopoDS_Solid

    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    sizes = COLUMNS * PITCH, math.ceil(bosses / COLUMNS) * PITCH, THICK
    box = BRepPrimAPI_MakeBox(gp_Pnt(left, 0.0, -THICK), *sizes)
    top = BRepBuilderAPI_MakeFace(TopoDS.Face(box.TopFace()))
    for k in range(bosses):
        j, i = divmod(k, COLUMNS)
        boss, foot = _boss(left + (i + 0.5) * PITCH, (j + 0.5) * PITCH)
        top.Add(TopoDS.Wire(BRepBuilderAPI_MakeWire(foot).Wire().Reversed()))
        explorer = TopExp_Explorer(boss, TopAbs_FACE)
        while explorer.More():
            builder.Add(shell, explorer.Current())
            explorer.Next()
    explorer = TopExp_Explorer(box.Shape(), TopAbs_FACE)
    while explorer.More():
        face = explorer.Current()
        builder.Add(shell, top.Face() if face.IsSame(box.TopFace()) else face)
        explorer.Next()
    solid = TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def _boss(x: float, y: float) -> tuple[Any, Any]:
    """Return the faces of a boss, and the circle at its foot."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.GC import GC_MakeArcOfCircle
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    points = [gp_Pnt(x + r, y, z) for r, z in PROFILE]
    half = math.sqrt(0.5)
    bend = gp_Pnt(x + PROFILE[0][0] - half, y, 1.0 - half)
    arc = GC_MakeArcOfCircle(points[0], bend, points[1]).Value()
    edges = [BRepBuilderAPI_MakeEdge(arc).Edge()]
    edges += [BRepBuilderAPI_MakeEdge(a, b).Edge() for a, b in itertools.pairwise(points[1:])]
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    axis = gp_Ax1(gp_Pnt(x, y, 0.0), gp_Dir(0.0, 0.0, 1.0))
    turned = BRepPrimAPI_MakeRevol(wire.Wire(), axis)
    return turned.Shape(), _lowest(turned.Shape())


def _lowest(shape: Any) -> Any:
    """Return the edge on z = 0, which the other edges of a boss are not."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp, TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer = TopExp_Explorer(shape, TopAbs_EDGE)
    while True:
        edge = TopoDS.Edge(explorer.Current())
        ends = TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge)
        if max(abs(BRep_Tool.Pnt_s(x).Z()) for x in ends) < NEAR:
            return edge
        explorer.Next()


def _net(points: int, place: int) -> Any:
    """Return a wavy bicubic surface, one of a row, whose knots are simple."""
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt  # of 8.0
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    poles = Array2_gp_Pnt(1, points, 1, points)
    for i, j in np.ndindex(points, points):
        height = WAVE * math.sin(WAVES * math.tau * i / points) * math.cos(math.tau * j / points)
        poles.SetValue(i + 1, j + 1, gp_Pnt(i + place * 1.1 * points, j, height))
    spans = points - DEGREE
    knots, multiplicities = Array1_double(1, spans + 1), Array1_int(1, spans + 1)
    for k in range(spans + 1):
        knots.SetValue(k + 1, float(k))
        multiplicities.SetValue(k + 1, 1 if 0 < k < spans else DEGREE + 1)
    return Geom_BSplineSurface(poles, knots, knots, multiplicities, multiplicities, DEGREE, DEGREE)


# Of each part how it is written, and the number of its samples.
PARTS: dict[str, tuple[Callable[[Path], None], int]] = {
    "10,006 faces": (lambda path: write_plates(path, 5, 2_494), SAMPLES),
    "100,000 faces": (lambda path: write_plates(path, 50, 24_925), 4 * SAMPLES),
    "277 faces, 60 x 60 control points": (lambda path: write_nets(path, 277, 60), SAMPLES),
    "6 faces, 200 x 200 control points": (lambda path: write_nets(path, 6, 200), SAMPLES),
}
LONG = "100,000 faces"
HOURS, MOST_GIB = 24.0, 16.0


def main() -> None:
    """Print a row for each part; with a file and a count, those of this file."""
    names = sys.argv[1:] or [x for x in PARTS if x != LONG]
    if len(names) == 2 and Path(names[0]).exists():
        print(measured(Path(names[0]), int(names[1])))
        return
    table = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # Open CASCADE prints what it writes
    print("| part | reading, CPU s | MB | sampling, CPU s | MB |", file=table)
    print("|---|---|---|---|---|", file=table)
    with table, tempfile.TemporaryDirectory() as folder:
        write_plates(Path(folder) / "small.step", 1, 4)
        _row(Path(folder) / "small.step", 1_000)
        for name in names:
            write, count = PARTS[name]
            path = Path(folder) / "part.step"
            write(path)
            print(f"| {name}, {count:,} samples | {_row(path, count)} |", file=table, flush=True)


def _row(path: Path, count: int) -> str:
    command = [sys.executable, __file__, str(path), str(count)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.strip().splitlines()[-1]


def measured(path: Path, count: int) -> str:
    """Return what reading and sampling take: seconds and memory of each, as cells of a row."""
    import gaussmap as gm

    warnings.simplefilter("ignore", gm.GaussmapWarning)
    part = gm.read_cad(path, time_limit=3600.0 * HOURS, memory_limit=MOST_GIB)
    child = resource.getrusage(resource.RUSAGE_CHILDREN)
    reading, begin = child.ru_utime + child.ru_stime, time.process_time()
    gm.sample(part, count)
    sampling = time.process_time() - begin
    read, own = child.ru_maxrss, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return f"{reading:.0f} | {read / 1024:.0f} | {sampling:.0f} | {own / 1024:.0f}"


if __name__ == "__main__":
    main()
