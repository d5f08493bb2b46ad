"""A bracket with fillets, bosses and holes, which nobody has tuned on: a STEP file."""

# Only `make parts-quality` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["write_bracket"]

# In millimetres: a plate and a wall of one thickness, three bosses, and the fillets between them.
LENGTH, WIDTH, HEIGHT, THICK = 100.0, 60.0, 45.0, 8.0
BOSSES = ((28.0, 32.0, 9.0, 14.0), (72.0, 32.0, 9.0, 14.0), (50.0, 48.0, 6.0, 5.0))
HOLE, BORE, BORE_HEIGHT = 0.5, 12.0, 28.0
AT_CORNER, AT_WALL, AT_BOSS, ON_BOSS = 10.0, 6.0, 2.0, 1.0
NEAR = 1e-6


def write_bracket(path: Path) -> None:
    """Make the bracket by Open CASCADE, and write it."""
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(bracket(), STEPControl_AsIs)
    writer.Write(str(path))


def bracket() -> Any:
    """Return the bracket."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    shape = BRepPrimAPI_MakeBox(LENGTH, WIDTH, THICK).Shape()
    solids = [BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), LENGTH, THICK, HEIGHT).Shape()]
    solids += [cylinder((x, y, 0.0), 2, r, THICK + high) for x, y, r, high in BOSSES]
    for solid in solids:
        fuse = BRepAlgoAPI_Fuse(shape, solid)
        fuse.SimplifyResult()  # faces that continue one another are one
        shape = fuse.Shape()
    rounded = BRepFilletAPI_MakeFillet(shape)
    for edge, radius in filleted(shape):
        rounded.Add(radius, edge)
    shape = rounded.Shape()
    holes = [cylinder((x, y, -1.0), 2, HOLE * r, HEIGHT) for x, y, r, _ in BOSSES]
    holes.append(cylinder((LENGTH / 2, -1.0, BORE_HEIGHT), 1, BORE, THICK + 2.0))
    for hole in holes:
        shape = BRepAlgoAPI_Cut(shape, hole).Shape()
    return shape


def cylinder(base: tuple[float, float, float], axis: int, radius: float, length: float) -> Any:
    """Return a cylinder along an axis."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    along = [0.0, 0.0, 0.0]
    along[axis] = 1.0
    frame = gp_Ax2(gp_Pnt(*base), gp_Dir(*along))
    return BRepPrimAPI_MakeCylinder(frame, radius, length).Shape()


def filleted(shape: Any) -> list[tuple[Any, float]]:
    """Return edges, each once, and the radii of their fillets."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    found, seen, explorer = [], set(), TopExp_Explorer(shape, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        curve = BRepAdaptor_Curve(edge)
        ends = curve.FirstParameter(), curve.LastParameter()
        a, b, c = (curve.Value(t) for t in (ends[0], sum(ends) / 2.0, ends[1]))
        key = tuple(round(x, 6) for x in (b.X(), b.Y(), b.Z()))
        if key not in seen and (radius := fillet(a, b, c)):
            found.append((edge, radius))
        seen.add(key)
        explorer.Next()
    return found


def fillet(first: Any, middle: Any, last: Any) -> float:
    """Return the radius of the fillet on an edge with these points, 0 if it has none."""
    x, y, z = middle.X(), middle.Y(), middle.Z()
    if first.Distance(last) < NEAR:  # a circle: the foot of a boss, or its upper end
        return AT_BOSS if abs(z - THICK) < NEAR else ON_BOSS if z > THICK else 0.0
    upright = abs(first.X() - last.X()) < NEAR and abs(first.Y() - last.Y()) < NEAR
    if upright and y > WIDTH - NEAR:
        return AT_CORNER
    if abs(y - THICK) < NEAR and abs(z - THICK) < NEAR:
        return AT_WALL
    # The upper corners of the wall.
    top = abs(z - HEIGHT) < NEAR and min(x, LENGTH - x) < NEAR
    return AT_CORNER if top else 0.0
