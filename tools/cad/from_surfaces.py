"""A part made of surfaces: faces, shared edges, and one orientation."""

import itertools
import warnings
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.checks import listed, positive_number, text
from ...runtime.base.errors import GaussmapWarning, InputError, SurfaceError, shown
from ...runtime.base.wording import plural
from ...runtime.domain.domain import closes
from ...runtime.domain.trim import polygons_of
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..files.lengths import METRES, checked_unit
from .face_pieces import FacePiece, pieces_of
from .measures import integrals_of, signs_of
from .part import Part, part_of
from .records import FaceRecord, PartRecord, Wire
from .sewing import Border, Sewn, sewn
from .shells import shells_of
from .surface_geometry import geometry_of_surface

# Boundaries count as coincident within this distance, relative to the size of all surfaces.
TOLERANCE = 1e-6


def part_of_surfaces(
    _: Part, surfaces: Sequence[Surface | str], tolerance: float | None, name: str, unit: str | None
) -> Part:
    """Return the result of `Part([...])`; raises the exceptions of `Part`."""
    held, known = _checked(surfaces), None if unit is None else checked_unit(unit)
    most = None if tolerance is None else positive_number(tolerance, "tolerance")
    faces = [_face(x) for x in held]
    # Areas are not known yet, and a face without an area is no piece: all faces get the area 1.
    bare = part_of(
        PartRecord(text(name, "name"), known or "", METRES.get(known or "", 1.0), False, faces)
    )
    pieces, reasons = pieces_of(bare.faces)
    if reasons:
        raise SurfaceError(next(iter(reasons.values())))
    points = np.concatenate([_corners(x) for x in pieces])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    borders = [border for x in pieces for border in _borders(x)]
    found = sewn(borders, TOLERANCE * size if most is None else most)
    if found.apart is not None:
        warnings.warn(f"{name}: {_of_gap(found.apart)}", GaussmapWarning, stacklevel=3)
    return _part(bare, faces, pieces, borders, found, points.mean(axis=0))


def _checked(surfaces: object) -> list[Surface]:
    """Return the surfaces; surfaces that are given by a grid of points become their splines.

    Raises InputError for an empty list, and for entries that are not surfaces.
    """
    given = None if isinstance(surfaces, Surface) else listed(surfaces)
    if not given:
        raise InputError(
            f"surfaces must be a list of surfaces, as in Part([first, second]), not "
            f"{shown(surfaces)}."
        )
    found = [named(x) for x in given]
    for k, surface in enumerate(found):
        if not isinstance(surface, Surface):
            raise InputError(
                f"surface {k} must be a Surface, or the name of one, not {shown(surface)}."
            )
    return [replace(x, grid=None) for x in found]


# --- faces ----------------------------------------------------------------------------------------


def _face(surface: Surface) -> FaceRecord:
    """Return a face of the kind that `geometry_of_surface` finds."""
    geometry, parameters = geometry_of_surface(surface)
    corners = np.array(list(itertools.product(*surface.domain))) @ parameters.T
    loops = [x @ parameters.T for x in _loops(surface)]
    domain = np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1).tolist()
    return FaceRecord(geometry, domain, loops=loops, area=1.0, name=surface.name)


def _loops(surface: Surface) -> list[Array]:
    """Return the boundary polygons of a surface; InputError for trims other than loops."""
    (u0, u1), (v0, v1) = surface.domain
    if surface.trim is None:
        return [np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])]
    (part, *others) = surface.trim.parts
    polygons = polygons_of(part)
    if others or not polygons:
        raise InputError(
            f"surface {surface.name!r} is trimmed by a predicate, by missing points or twice; a "
            "part takes surfaces that are trimmed by loops once."
        )
    low, high = np.array(surface.domain).T
    around = np.array([closes(ends) for ends in surface.boundary])
    for x in polygons:
        if (((x < low) | (x > high)) & around).any():
            raise InputError(
                f"a loop of surface {surface.name!r} runs beyond its domain; a part takes loops "
                "inside of it: cut them at the seam."
            )
    return [np.clip(x, low, high) for x in polygons]


def _corners(piece: FacePiece) -> Array:
    """Return points (k, 3) spread over a surface."""
    u0, v0, u1, v1 = piece.boxes.T
    places = np.concatenate([np.stack(x, axis=1) for x in ((u0, v0), (u1, v1))])
    return piece.jets(*places.T.copy())[:, 0]


def _borders(piece: FacePiece) -> list[Border]:
    """Return the boundaries of a face, with the face on their left."""
    whole = piece.surface.trim is None
    found = []
    for polygon, sign in zip(piece.polygons, signs_of(piece), strict=True):
        proper = polygon[np.any(polygon != np.roll(polygon, 1, axis=0), axis=1)]
        way = proper if sign > 0.0 else proper[::-1]
        found.append(Border(piece.face.index, piece.surface, way, whole))
    return found


# --- the part -------------------------------------------------------------------------------------


def _part(
    bare: Part,
    faces: Sequence[FaceRecord],
    pieces: Sequence[FacePiece],
    borders: Sequence[Border],
    found: Sewn,
    centre: Array,
) -> Part:
    """Return the part made of faces whose edges are known."""
    integrals = [integrals_of(x, centre) for x in pieces]
    for face, (_, area) in zip(faces, integrals, strict=True):
        if not area > 0.0:
            raise SurfaceError(f"surface {face.name!r} has no area.")
    shells = shells_of(pieces, found, borders, [x[0] for x in integrals])
    shell_of = {face: x for x in shells for face in x.signs}
    wires = defaultdict[int, list[Wire]](list)
    for border, wire in zip(borders, found.wires, strict=True):
        wires[border.face].append(wire)
    made = [
        replace(
            face,
            reversed=shell_of[k].signs[k] < 0,
            area=integrals[k][1],
            solid_index=shell_of[k].solid,
            wires=wires[k],
        )
        for k, face in enumerate(faces)
    ]
    record = PartRecord(
        bare.name, bare.unit, bare.metres, all(x.closed for x in shells), made,
        [""] * (1 + max(x.solid for x in shells)), found.edges, found.vertices,
        list(_warnings(made, found)),
    )  # fmt: skip
    return part_of(record)


def _warnings(faces: Sequence[FaceRecord], found: Sewn) -> Iterator[str]:
    """Yield warnings about flipped surfaces, edges of more than two faces, and narrow gaps."""
    flipped = [k for k, face in enumerate(faces) if face.reversed]
    if len(flipped) == 1:
        yield f"surface {flipped[0]} ({faces[flipped[0]].name!r}) is flipped."
    elif flipped:
        yield f"{len(flipped):,} surfaces are flipped: {', '.join(map(str, flipped))}."
    many = sum(len(x.faces) > 2 for x in found.edges)
    if many:
        yield f"there {'is' if many == 1 else 'are'} {plural(many, 'edge')} of more than two faces."
    if found.apart is not None:
        yield _of_gap(found.apart)


def _of_gap(apart: float) -> str:
    return (
        f"there are borders that nearly coincide, up to {apart:.3g}, and stay apart; a larger "
        "tolerance joins them."
    )
