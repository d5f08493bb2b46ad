"""Sets of unit normals: icosahedron, Fibonacci lattice, HEALPix, random; in the plane a circle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...generated.icosahedron import FACE_RADIUS
from ..base.checks import whole_number
from ..base.errors import InputError, in_memory
from ..base.extras import from_extra
from ..base.limits import MOST_FREQUENCY
from ..base.memory import check_memory
from ..base.threads import over_ranges
from .kernels.icosphere import new_line, write_points
from .unit import PIECE, as_normals, in_pieces, normalized

GOLDEN = (1 + math.sqrt(5)) / 2
# The parts of an icosphere that threads compute: all corners (one part), each edge, each face.
PARTS = 1 + 30 + 20
PARTS_AT_A_TIME = 5


@in_memory
def icosphere(frequency: int) -> NDArray[np.float64]:
    """Return the vertices of an icosahedron whose edges are cut into equal parts.

    Every face carries a planar triangular lattice that is projected from the centre to the unit
    sphere ("uniform refinement", paper, Sect. 4.2).

    Parameters
    ----------
    frequency : int
        The number ν of parts of an edge, from 1 to 10,000.

    Returns
    -------
    (10 ν² + 2, 3) float64 array
        Unit normals: the 12 vertices of the icosahedron, then the points inside its 30 edges, then
        those inside its 20 faces.

    Raises
    ------
    InputError
        If `frequency` is not an integer in this range.

    Notes
    -----
    Many of the points lie in common symmetry planes; those of `fibonacci` do not.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.icosphere(32).shape
    (10242, 3)

    """
    nu = whole_number(frequency, "frequency", most=MOST_FREQUENCY)
    count = 10 * nu**2 + 2
    check_memory("icosphere", count)
    normals = np.empty((count, 3))

    def work(first: int, last: int) -> None:
        write_points(nu, first, last, normals, *new_line())

    list(over_ranges(work, PARTS, PARTS_AT_A_TIME, 1 if count < PIECE else None))
    return normals


def frequency_within(angle: float) -> int:
    """Return the least ν for which `icosphere(ν)` has a covering radius of at most `angle` degrees.

    Raises InputError if there is none.
    """
    tangent = math.tan(math.radians(angle))
    if tangent * MOST_FREQUENCY < FACE_RADIUS:
        least = math.degrees(math.atan(FACE_RADIUS / MOST_FREQUENCY))
        raise InputError(f"angle must be at least {least:.4f} degrees, not {angle:g}.")
    return max(1, math.ceil(FACE_RADIUS / tangent))


@in_memory
def fibonacci(count: int) -> NDArray[np.float64]:
    """Return unit normals on a Fibonacci lattice, from +z to −z.

    The points are uniform (each represents the same area of the sphere) and in general position: no
    symmetry aligns them with a surface.

    Parameters
    ----------
    count : int
        The number of normals, at least 1.

    Returns
    -------
    (count, 3) float64 array
        Unit normals.

    Raises
    ------
    InputError
        If `count` is not such a number.

    Examples
    --------
    >>> import gaussmap as gm
    >>> normals = gm.fibonacci(1000)
    >>> normals.shape
    (1000, 3)
    >>> bool((normals[:-1, 2] > normals[1:, 2]).all())
    True

    """
    total = whole_number(count, "count")
    return part_of_fibonacci(total, 0, total)


@in_memory
def healpix(nside: int) -> NDArray[np.float64]:
    """Return the centres of the pixels of HEALPix, ring by ring from +z to −z.

    Pixels have equal areas, and their centres lie on rings of equal latitude. The centres on the
    equator and on some meridians lie in planes of symmetry.

    Parameters
    ----------
    nside : int
        The resolution, a power of 2 up to 8,192.

    Returns
    -------
    (12 nside², 3) float64 array
        Unit normals.

    Raises
    ------
    InputError
        If `nside` is not a power of 2 in this range.
    MissingExtraError
        If astropy-healpix is not installed; the extra "spheres" contains it.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.directions.healpix(16).shape
    (3072, 3)

    """
    size = whole_number(nside, "nside", most=MOST_FREQUENCY)
    if size & (size - 1):
        raise InputError(f"nside must be a power of 2, not {size}.")
    library = from_extra("astropy_healpix", "spheres", "HEALPix")
    check_memory("healpix", 12 * size**2)
    xyz = library.healpix_to_xyz(np.arange(12 * size**2), size, order="ring")
    return as_normals(np.stack(xyz, axis=1))


@in_memory
def random(count: int, *, seed: int = 0) -> NDArray[np.float64]:
    """Return unit normals that are independent and uniform on the sphere.

    Parameters
    ----------
    count : int
        The number of normals, at least 1.
    seed : int, default 0
        The seed of the random numbers, at least 0. The same seed gives the same normals (with the
        same version of NumPy), and a smaller `count` gives a prefix of a larger one.

    Returns
    -------
    (count, 3) float64 array
        Unit normals.

    Raises
    ------
    InputError
        If `count` or `seed` is not an integer in its range.

    Notes
    -----
    These normals are less evenly distributed than a lattice: about a fraction 1/e of all regions of
    area 4π/count contains no normal.

    Examples
    --------
    >>> import gaussmap as gm
    >>> normals = gm.directions.random(500, seed=1)
    >>> bool((normals[:10] == gm.directions.random(10, seed=1)).all())
    True

    """
    total, start = whole_number(count, "count"), whole_number(seed, "seed", least=0)
    check_memory("random", total)
    return as_normals(np.random.default_rng(start).standard_normal((total, 3)))


def part_of_fibonacci(
    count: int, first: int, last: int, threads: int | None = None
) -> NDArray[np.float64]:
    """Return the rows [first, last) of `fibonacci(count)`."""

    def rows(begin: int, end: int) -> NDArray[np.float64]:
        k = np.arange(begin, end)
        z = 1.0 - (2.0 * k + 1.0) / count
        angle = spiral_angle(k)
        radius = np.sqrt((1.0 - z) * (1.0 + z))
        return normalized(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z]))

    return in_pieces(rows, first, last, threads)


def spiral_angle(k: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the azimuths, in radians, of the points of a Fibonacci lattice with indices k."""
    return 2.0 * math.pi * np.modf(k / GOLDEN)[0]


def circle(count: int) -> NDArray[np.float64]:
    """Return uniform unit normals on the circle, for planar curves.

    Parameters
    ----------
    count : int
        The number of normals, at least 1.

    Returns
    -------
    (count, 2) float64 array
        Unit normals; normal k is at the angle 2π (k + ½)/count. They have the symmetries of the set
        of angles, bit for bit: reflections in both axes if `count` is even, and in the diagonals if
        it is a multiple of 4.

    Raises
    ------
    InputError
        If `count` is not an integer in this range.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.directions.circle(4).round(3).tolist()
    [[0.707, 0.707], [-0.707, 0.707], [-0.707, -0.707], [0.707, -0.707]]

    """
    total = whole_number(count, "count")
    check_memory("circle", total)
    # Angles are integers in units of 1/(8 count) of a turn: a quarter turn has 2 count units, and
    # its second half is the mirror image of the first one.
    quarter, place = np.divmod(4 * (2 * np.arange(total) + 1), 2 * total)
    beyond = place > total
    angle = np.pi / (4 * total) * np.where(beyond, 2 * total - place, place)
    x = np.cos(angle)
    y = np.where(place == total, x, np.sin(angle))
    x, y = np.where(beyond, y, x), np.where(beyond, x, y)
    choices = np.array([[x, y], [-y, x], [-x, -y], [y, -x]])
    return np.ascontiguousarray(choices[quarter, :, np.arange(total)])


def arc_of_normals(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Return unit normals (count, 2) at the middles of equal parts of an interval of angles."""
    angle = low + (high - low) * ((np.arange(count) + 0.5) / count)
    return np.column_stack([np.cos(angle), np.sin(angle)])
