"""Samples at prescribed normals, before the gaps between them are filled."""

import math
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property, partial
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.errors import GaussmapError, GaussmapWarning
from ...runtime.onto_surface.on_spline import OnSpline
from ...runtime.samples.fields import ARRAY_NAMES_ON_SURFACE, GIVEN_NAMES, dtype_of, row_shape
from ...runtime.samples.samples import Samples
from .chosen_normals import NORMALS_PER_SAMPLE, Chosen, choose
from .fibonacci_lattice import Lattice
from .space import Space

# If a lattice gives too many samples, a coarser one replaces it: the number of normals is
# multiplied by the ratio of the allowed samples to the samples found, and by this factor.
FEWER = 0.98


class PieceSamples(NamedTuple):
    """Samples at normals (S, 3) on the piece with the index `piece`."""

    piece: int
    samples: Samples
    normals: Array


@dataclass(frozen=True, eq=False)
class Given:
    """Samples at normals (S, 3) on some pieces of a `Space`, with `density` normals per steradian.

    If `same_normals` is False, each piece has its own normals, and `normals` are those of all
    pieces, concatenated. `estimated` are the indices of the pieces without a proof that all points
    are found.
    """

    space: Space
    normals: Array = field(default_factory=lambda: np.empty((0, 3)))
    density: float = 0.0
    found: tuple[PieceSamples, ...] = ()
    same_normals: bool = True
    estimated: tuple[int, ...] = ()

    def __len__(self) -> int:
        return sum(len(x.samples) for x in self.found)

    @cached_property
    def pieces(self) -> Indices:
        """The indices (N,) of the pieces on which the samples lie."""
        numbers = np.array([x.piece for x in self.found], dtype=np.int64)
        return np.repeat(numbers, [len(x.samples) for x in self.found])

    @property
    def rows(self) -> Array:
        """The rows (N, 7) of the samples: scaled point, unit normal and K."""
        points, normals, K = (
            self.array(x, np.float64) for x in ("points", "normals", "gaussian_curvature")
        )
        return np.column_stack([self.space.scaled_points(points), normals, K])

    @property
    def samples_per_steradian(self) -> float:
        """Samples per steradian of the Gaussian image; normals per steradian if no sample is known.

        The density of the normals is also returned if the Gaussian image has no area.
        """
        image = float(self.space.solid_angles(self.density).sum())
        return len(self) / image if len(self) and image > 0.0 else self.density

    @property
    def developable(self) -> int | None:
        """The number of patches that have no support function; None if no piece was searched."""
        numbers = [x.samples.report.developable_patches for x in self.found]
        return sum(x or 0 for x in numbers) if numbers else None

    def array(self, name: str, dtype: DTypeLike) -> NDArray[Any]:
        """Return the field `name` (N, …) of the samples of all pieces."""
        dtype, parts, first = dtype_of(name, dtype), [np.empty((0, *row_shape(name)))], 0
        for piece, samples, normals in self.found:
            indices = self.space.pieces[piece].indices
            known = getattr(samples, name)
            if known is None:
                known = np.full((len(samples), *row_shape(name)), indices.get(name, math.nan))
            elif name == "patch_index":
                known = known + indices.get(name, 0)
            elif name == "normal_index":
                known = known + first
            parts.append(known)
            first += 0 if self.same_normals else len(normals)
        return np.concatenate([x.astype(dtype, copy=False) for x in parts])


def at_normals(space: Space, normals: Array, curved: Iterable[int], progress: bool) -> Given:
    """Return all points whose normal is one of the given normals (S, 3), each point once.

    On pieces with a proof all points are found. Of the other pieces, only those with an index in
    `curved` are searched, on their splines.
    """
    density, found, estimated = len(normals) / (4 * math.pi), list[PieceSamples](), list[int]()
    for k, piece in enumerate(space.pieces):
        proved = piece.proved_at(normals, space.threads)
        if proved is None:
            estimated.append(k)
        else:
            found += [PieceSamples(k, x, normals) for x in proved]

    def search(geometry: OnSpline) -> tuple[Samples, Array]:
        fields = ARRAY_NAMES_ON_SURFACE + GIVEN_NAMES
        return geometry.samples_at(normals, fields, np.float64, progress), normals

    found += _searched(space, (k for k in curved if k in estimated), search)
    found.sort(key=attrgetter("piece"))
    return Given(space, normals, density, tuple(found), estimated=tuple(estimated))


def at_lattices(
    space: Space, density: float, pieces: Iterable[int], progress: bool, most: int | None = None
) -> Given:
    """Return samples at lattices of `density` normals per steradian, one lattice for each piece.

    As long as more than `most` samples are found, coarser lattices are searched. A piece has no
    samples if less than half a sample is expected.
    """
    pieces = list(pieces)
    while True:
        search = partial(_at_lattice, density=density, progress=progress)
        given = _given(space, density, tuple(_searched(space, pieces, search)))
        if most is None or len(given) <= most:
            return given
        density *= FEWER * most / len(given)


def at_count(space: Space, counts: Indices, progress: bool) -> Given:
    """Return samples at lattices of normals: about counts[k] samples on piece k."""
    parts, densities = list[PieceSamples](), [0.0]
    for piece in np.flatnonzero(counts).tolist():

        def search(geometry: OnSpline, count: int = int(counts[piece])) -> tuple[Samples, Array]:
            chosen = choose(geometry, count, progress)
            densities.append(chosen.density)
            return _at_chosen(geometry, chosen, progress)

        parts += _searched(space, [piece], search)
    return _given(space, max(densities), tuple(parts))


def _given(space: Space, density: float, found: tuple[PieceSamples, ...]) -> Given:
    normals = np.concatenate([np.empty((0, 3)), *(x.normals for x in found)])
    return Given(space, normals, density if found else 0.0, found, same_normals=False)


def _searched(
    space: Space, pieces: Iterable[int], search: Callable[[OnSpline], tuple[Samples, Array] | None]
) -> Iterable[PieceSamples]:
    """Yield the samples that `search` finds on the splines of pieces.

    An error on one of several pieces becomes a warning; the other pieces are searched.
    """
    for k in pieces:
        try:
            for geometry in space.pieces[k].geometries(space.threads):
                found = search(geometry)
                if found is not None:
                    yield PieceSamples(k, *found)
        except GaussmapError as error:
            if len(space.pieces) == 1:
                raise
            label = space.pieces[k].label
            message = f"{label} has no samples at normals: {error}"
            warnings.warn(message, GaussmapWarning, stacklevel=8)


def _at_lattice(geometry: OnSpline, density: float, progress: bool) -> tuple[Samples, Array] | None:
    lattice = Lattice.around(geometry.spline, geometry.reach)
    image = geometry.cell_measure.curved_solid_angle(density)
    if round(density * image) == 0:
        return None
    densest = lattice.density_of(NORMALS_PER_SAMPLE * max(round(density * image), 1000))
    chosen = Chosen(lattice, min(density, densest))
    return _at_chosen(geometry, chosen, progress)


def _at_chosen(geometry: OnSpline, chosen: Chosen, progress: bool) -> tuple[Samples, Array]:
    """Return the samples at the chosen normals, with all fields, and these normals."""
    return chosen.samples(geometry, ARRAY_NAMES_ON_SURFACE, np.float64, progress)
