"""A part: its faces, solids and unit, from a CAD file or from several surfaces."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError, SurfaceError
from ...runtime.base.wording import plural
from ...runtime.samples.whole import Whole
from ..files.paths import PathLike
from .dimensions import dimensions_of
from .part_arrays import geometry_of, packed
from .part_methods import Methods
from .records import Geometry, PartRecord
from .saving import read_arrays, write_arrays

if TYPE_CHECKING:
    from ...runtime.surface.surface import Surface

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Part(Methods, Whole):
    """Several faces as one object: one count, one density, one orientation, shared edges.

    `read_cad` and `read_part` return parts, and `Part([...])` makes one of surfaces. Boundaries of
    the surfaces that coincide, wholly or partly, become edges, which meshes share. Surfaces are
    flipped where a consistent orientation requires it: normals of closed sets point outward, and
    other connected sets are oriented as their first surface. `warnings` names the flipped surfaces.
    `gap`, `open_edges` and `closed` say how well the surfaces fit.

    `sample` and `GaussMap` take a part in place of a surface. Lengths are in the unit L of its
    file. A part can be pickled if its callables can, and needs no CAD library.

    Parameters
    ----------
    surfaces : sequence of Surface or str
        The surfaces, or their names in the catalogue. Trims must be loops; a surface given by a
        grid of points is its spline.
    tolerance : float, optional
        Boundaries coincide if their distance is nowhere larger than this, in L. By default, 1e-6 of
        the size of the part.
    name : str, default "part"
        The name in messages.
    unit : str, optional
        The unit L of the surfaces, "mm", "in" or another unit of `read_cad`, which files and
        summaries of samples state. Nothing is converted.

    Attributes
    ----------
    arrays : dict of str to array
        The arrays of all faces, in the format of the files of `save`.
    about : dict
        All that is not an array, such as names.
    surfaces : dict of int to Surface
        The surfaces of faces of the kind "surface", which are not given by numbers, by face index.

    Raises
    ------
    InputError, UnknownNameError
        For invalid arguments, an unknown unit, a trim that is not one set of loops in the domain,
        and if the surfaces cannot be oriented consistently, as on a Möbius band.
    SurfaceError
        If a surface cannot be evaluated, or is no larger than the tolerance.

    Warns
    -----
    GaussmapWarning
        If boundaries are farther apart than the tolerance, and nearly coincide.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> tube = gm.Surface.from_sympy(
    ...     ("cos(u)", "sin(u)", "v"), ("u", "v"), ((0, "2*pi"), (0, 2)), (True, False), name="tube"
    ... )
    >>> half = gm.Surface.from_sympy(
    ...     ("cos(v)*cos(u)", "cos(v)*sin(u)", "-sin(v)"), ("u", "v"), ((0, "2*pi"), (0, "pi/2")),
    ...     (True, False), name="half",
    ... )
    >>> cup = gm.Part([tube, half], name="cup")
    >>> cup, cup.open_edges, cup.closed, cup.gap < 1e-12, cup.warnings
    (Part(cup: 2 faces, 0 solids), 1, False, True, ("surface 1 ('half') is flipped.",))
    >>> len(gm.sample(cup, 200)), round(cup.area / np.pi, 9)
    (200, 6.0)
    >>> cup.faces[0].kind, sorted(cup.surfaces)
    ('surface', [0, 1])
    >>> ring = gm.Part(["torus"], unit="mm").select(kind="torus")
    >>> ring.unit, ring.faces[0].dimensions["minor_radius"]
    ('mm', 0.35)

    >>> from gaussmap.tools.cad.examples import box
    >>> part = box(1.0, 2.0, 3.0)
    >>> part.name, part.unit, part.metres, len(part.faces), part.faces[0].kind
    ('box', 'mm', 0.001, 6, 'plane')
    >>> part.solids, part.oriented, part.area, part.failed, part.warnings
    ((Solid(0 'box': 6 faces),), True, 22.0, (), ())
    >>> part.arrays["area"].shape, part.about["version"]
    ((6,), 2)
    >>> gm.sample(part, 100).weights().sum().round(9)
    np.float64(22.0)

    """

    arrays: dict[str, NDArray[Any]]
    about: dict[str, Any]
    surfaces: Mapping[int, Surface] = field(default_factory=dict)

    def __init__(
        self,
        surfaces: Sequence[Surface | str],
        *,
        tolerance: float | None = None,
        name: str = "part",
        unit: str | None = None,
    ) -> None:
        vars(self).update(self._made_of(surfaces, tolerance, name, unit).__getstate__())

    @classmethod
    def _of(
        cls,
        arrays: dict[str, NDArray[Any]],
        about: dict[str, Any],
        surfaces: Mapping[int, Surface] | None = None,
    ) -> Part:
        """Return a part from its arrays, and from the surfaces that arrays cannot hold."""
        part = cls.__new__(cls)
        vars(part).update(arrays=arrays, about=about, surfaces=dict(surfaces or {}))
        return part

    def __repr__(self) -> str:
        faces, solids = plural(len(self), "face"), plural(len(self.solids), "solid")
        unit = f", {self.unit}" if self.unit else ""
        return f"Part({self.name}: {faces}, {solids}{unit})"

    def __len__(self) -> int:
        return len(self.arrays["area"])

    @property
    def name(self) -> str:
        """The name of the part: the name of its file, or the given name."""
        return str(self.about.get("name", "part"))

    @property
    def unit(self) -> str:
        """The unit L of all lengths, such as "mm" or "in"; "" if it is not known."""
        return str(self.about.get("unit", ""))

    @property
    def metres(self) -> float:
        """The length of the unit, in metres."""
        return float(self.about.get("metres", 1.0))

    @property
    def oriented(self) -> bool:
        """Whether the normals of all faces are known to point outward, out of solids."""
        return bool(self.about.get("oriented", False))

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """All faces, including those that `failed`."""
        return tuple(Face(self, k) for k in range(len(self)))

    @property
    def failed(self) -> tuple[Face, ...]:
        """The faces that cannot be used; their `reason` says why."""
        return tuple(self.faces[k] for k in sorted(map(int, self._reasons)))

    @cached_property
    def area(self) -> float:
        """The area of all faces inside their trims, in L², to about 1e-6."""
        areas = self.arrays["area"]
        return float(areas[np.isfinite(areas)].sum())

    @cached_property
    def bounds(self) -> Array:
        """The smallest and the largest x, y, z (2, 3) of all faces inside their trims, in L.

        They are values of `GaussMap.support`, whose `errors` bound their errors. Raises
        SurfaceError if no face can be used.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import box
        >>> box(1.0, 2.0, 3.0).bounds
        array([[0., 0., 0.],
               [1., 2., 3.]])

        """
        return self._bounds_of()

    @cached_property
    def volume(self) -> float:
        """The volume of the solids, in L³, without their cavities.

        It is a third of the sum of area · (mean of x · n) over the faces. The means are integrals
        along the boundaries of the faces, by Gauss's rule: exact for planes, and to about 1e-6 for
        faces whose boundaries are lines of constant u or v. Other boundaries are approximated by
        polygons (see `Face.loops`): where these deviate by 1e-4 of the size of a face, the most in
        parts that `read_cad` reads, the relative error of the volume of a cylinder with a slanted
        end is 3e-5. Where solids overlap, both count.

        Raises SurfaceError if no faces enclose a solid, if a face of a closed solid has failed, and
        for parts made by `select`. Faces of open shells do not count; if there are any, the volume
        comes with a warning.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import box
        >>> round(box(1.0, 2.0, 3.0).volume, 12)
        6.0

        """
        return self._volume_of()

    @cached_property
    def gap(self) -> float:
        """The largest distance between two faces, or ends of one face, along a shared edge, in L.

        It is measured at all points of edges that the part holds; it is 0 if no edge is shared.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import box
        >>> box(1.0, 2.0, 3.0).gap
        0.0

        """
        return self._gap_of()

    @cached_property
    def open_edges(self) -> int:
        """The number of edges with a face on one side only.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import box
        >>> box().open_edges, box().select(index=[0, 1, 2]).open_edges
        (0, 8)

        """
        return int((self._sides_of_edges == 1).sum())

    @cached_property
    def closed(self) -> bool:
        """Whether each edge has exactly two sides, on one face or on two.

        False if a face has `failed`, or if the edges around a face are not known.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import box
        >>> box().closed, box().select(index=[0, 1, 2]).closed
        (True, False)

        """
        known = not self.failed and all(x.wires for x in self.faces)
        return known and bool((self._sides_of_edges == 2).all())

    @property
    def _sides_of_edges(self) -> NDArray[np.int64]:
        """For each edge that is not degenerate, the number of its sides."""
        return np.diff(self.arrays["edge_side_starts"])[~self.arrays["edge_degenerate"]]

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """The solids; faces that belong to none are loose."""
        index = self.arrays["solid_index"]
        names = list(self.about.get("solid_names", ()))
        count = max(len(names), int(index.max(initial=-1)) + 1)
        order = np.argsort(index, kind="stable")
        ends = np.searchsorted(index[order], np.arange(count + 1))
        faces = [order[ends[k] : ends[k + 1]] for k in range(count)]
        names += [""] * (count - len(names))
        return tuple(Solid(self, k, str(names[k]), x) for k, x in enumerate(faces))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about problems in reading or making the part."""
        return tuple(map(str, self.about.get("warnings", ())))

    @cached_property
    def _reasons(self) -> dict[str, str]:
        return dict(self.about.get("reasons", {}))

    def save(self, path: PathLike) -> None:
        """Write the part to a `.npz` file, which `read_part` reads.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file.

        Raises
        ------
        UnknownNameError
            If the suffix is not `.npz`.
        FileError
            If the file cannot be written.
        InputError
            If a face is a surface that is not given by numbers, see `surfaces`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> from gaussmap.tools.cad.examples import box
        >>> box().save("box.npz")
        >>> gm.read_part("box.npz")
        Part(box: 6 faces, 1 solid, mm)

        """
        if self.surfaces:
            face = self.faces[min(self.surfaces)]
            raise InputError(
                f"{face.label} is a function in memory, which no file holds; only planes, "
                "cylinders, NURBS and other faces that are given by numbers are saved."
            )
        write_arrays(self.arrays, path)

    def __getstate__(self) -> dict[str, object]:
        """Return the pickled state: the fields, without cached values."""
        return {"arrays": self.arrays, "about": self.about, "surfaces": self.surfaces}


@dataclass(frozen=True, eq=False, repr=False)
class Face:
    """A face of a part: a surface and its trim.

    Attributes
    ----------
    part : Part
        The part.
    index : int
        The index in `part.faces`.

    """

    part: Part
    index: int

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"Face({self.index}{name}: {self.kind}, area {self.area:g})"

    @property
    def kind(self) -> str:
        """One of plane, cylinder, cone, sphere, torus, nurbs, revolution, extrusion, offset.

        Planes, cylinders, cones, spheres and tori of the catalogue and NURBS, moved or not, have
        their kind; any other surface of `Part([...])` is a "surface". A face that failed before its
        kind was determined is "unknown".
        """
        return self.geometry.kind

    @property
    def area(self) -> float:
        """The area inside the trim, in L², to about 1e-6.

        For a part from a file, Open CASCADE computes it.
        """
        return float(self._row("area"))

    @property
    def name(self) -> str:
        """The name in the file, or ""."""
        return str(self.part.about.get("face_names", {}).get(str(self.index), ""))

    @property
    def color(self) -> tuple[float, float, float] | None:
        """Red, green and blue, from 0 to 1; None if the file gives none."""
        red, green, blue = self._row("color").tolist()
        return None if np.isnan(red) else (red, green, blue)

    @property
    def source_index(self) -> int:
        """The index of this face in the part that was read or made.

        It equals `index` unless `part` is a selection.
        """
        places = self.part.about.get("source_indices")
        return int(places[self.index]) if places else self.index

    @property
    def solid_index(self) -> int:
        """The index in `part.solids` of the solid that the face belongs to; −1 for none."""
        return int(self._row("solid_index"))

    @property
    def reversed(self) -> bool:
        """Whether the normal is opposite to x_u × x_v of the geometry."""
        return bool(self._row("reversed"))

    @property
    def reason(self) -> str:
        """The reason why the face failed; "" if it did not."""
        return self.part._reasons.get(str(self.index), "")

    @property
    def domain(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The bounding box of the loops: ((u0, u1), (v0, v1))."""
        (u0, u1), (v0, v1) = self._row("domain").tolist()
        return (u0, u1), (v0, v1)

    @property
    def periods(self) -> tuple[float, float]:
        """The periods of the geometry in u and v, 0 where not periodic."""
        along_u, along_v = self._row("periods").tolist()
        return along_u, along_v

    @property
    def geometry(self) -> Geometry:
        """The surface without its trim, as arrays: views of the arrays of the part."""
        found, held = geometry_of(self.part.arrays, self.index), self.part.surfaces.get(self.index)
        return found if held is None else replace(found, surface=held)

    @cached_property
    def dimensions(self) -> dict[str, Any]:
        """The dimensions of a plane, cylinder, cone, sphere or torus; empty for other faces.

        plane: `point`, `normal`. cylinder: `point` on its `axis`, `radius`. cone: `apex`, `axis`
        (towards its wide end), `half_angle` in degrees. sphere: `centre`, `radius`. torus:
        `centre`, `axis`, `major_radius`, `minor_radius`. Directions have unit length, lengths are
        in L. `hollow` says whether normals point inward, to the axis or centre, as in a hole.

        Examples
        --------
        >>> from gaussmap.tools.cad.examples import all_kinds
        >>> all_kinds().faces[1].dimensions
        {'point': array([0., 0., 0.]), 'axis': array([0., 0., 1.]), 'radius': 1.0, 'hollow': False}

        """
        return {} if self.reason else dimensions_of(self.geometry, self.domain, self.reversed)

    @property
    def loops(self) -> tuple[Array, ...]:
        """The closed polygons (k, 2) that trim the face; first points are not repeated.

        They are in u and v of the file: if the face is `reversed`, u of `surface` runs backwards.
        """
        arrays = self.part.arrays
        first, last = arrays["face_loops"][self.index : self.index + 2].tolist()
        starts = arrays["loop_point_starts"]
        return tuple(arrays["loop_points"][starts[k] : starts[k + 1]] for k in range(first, last))

    @property
    def wires(self) -> tuple[tuple[tuple[int, bool], ...], ...]:
        """The edges along each loop, in order: an index, and whether it is traversed backwards.

        The index is that of the side of the edge in `part.arrays`. The face lies to the left of the
        loop, seen from where x_u × x_v points; () if the file of the part has no wires.
        """
        arrays = self.part.arrays
        first, last = arrays["face_wires"][self.index : self.index + 2].tolist()
        sides, backwards = arrays["wire_sides"], arrays["wire_reversed"]
        ends = arrays["wire_side_starts"][first : last + 1].tolist()
        return tuple(
            tuple(zip(sides[a:b].tolist(), backwards[a:b].tolist(), strict=True))
            for a, b in itertools.pairwise(ends)
        )

    @cached_property
    def surface(self) -> Surface:
        """The surface with its trim.

        Its parameters are those of the file, except that u is reversed if the face is `reversed`,
        so that its normals are those of the face. Raises SurfaceError for a face that failed.
        """
        if self.reason:
            raise SurfaceError(f"{self.label} cannot be used: {self.reason}.")
        from .faces import face_surface

        return face_surface(
            self.geometry, self.domain, self.loops, is_reversed=self.reversed, name=self.label
        )

    @property
    def label(self) -> str:
        """The name of the face in messages."""
        name = f" ({self.name!r})" if self.name else ""
        return f"face {self.index}{name} of {self.part.name!r}"

    def _row(self, name: str) -> NDArray[Any]:
        return self.part.arrays[name][self.index]

    def __getstate__(self) -> dict[str, object]:
        """Return the pickled state: the fields, without cached values."""
        return {"part": self.part, "index": self.index}


@dataclass(frozen=True, eq=False, repr=False)
class Solid:
    """A solid of a part.

    Attributes
    ----------
    part : Part
        The part.
    index : int
        The index in `part.solids`.
    name : str
        The name in the file, or "".
    faces : (k,) int64 array
        The indices of its faces.

    """

    part: Part
    index: int
    name: str
    faces: NDArray[np.int64]

    def __repr__(self) -> str:
        return f"Solid({self.index} {self.name!r}: {plural(len(self.faces), 'face')})"

    @property
    def area(self) -> float:
        """The area of its faces, in L²."""
        return float(np.nansum(self.part.arrays["area"][self.faces]))


def part_of(record: PartRecord) -> Part:
    """Return the part that a record in memory describes, without checks."""
    from .saving import about_of

    arrays = packed(record)
    held = {k: x.geometry.surface for k, x in enumerate(record.faces) if x.geometry.surface}
    return Part._of(arrays, about_of(arrays), held)


def read_part(path: PathLike) -> Part:
    """Read a part from a `.npz` file that `Part.save` wrote; no CAD library is needed.

    Nothing in the file is unpickled.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file.

    Returns
    -------
    Part
        The part.

    Raises
    ------
    UnknownNameError
        If the suffix is not `.npz`.
    FileError
        If the file is missing, unreadable, damaged, or not from gaussmap.

    See Also
    --------
    sample : samples of a part.

    Examples
    --------
    >>> import gaussmap as gm
    >>> from gaussmap.tools.cad.examples import box
    >>> box(1.0, 2.0, 3.0).save("box.npz")
    >>> part = gm.read_part("box.npz")
    >>> part, part.faces[0]
    (Part(box: 6 faces, 1 solid, mm), Face(0 'side': plane, area 6))
    >>> samples = gm.sample(part, 100)
    >>> len(samples), sorted(set(samples.face_index.tolist()))
    (100, [0, 1, 2, 3, 4, 5])

    """
    return Part._of(*read_arrays(path))
