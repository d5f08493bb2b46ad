"""Graded grids: samples where parameter lines cross, spaced by the rate at which the normal turns.

Where parameter lines are close to lines of curvature, the cells of such a grid are long where the
surface is curved in one direction only: such a grid needs far fewer samples for the same angles
between normals than round cells do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...generated.spline import SCALE
from ...runtime.base.aliases import Array, Indices
from ...runtime.onto_surface.on_spline import OnSpline
from .breaks import breaks_along
from .grid import Grid
from .lines import Axis
from .space import Space
from .steps import Forms, Steps, equal_steps, steps_for_count

# The fundamental forms are evaluated at about this number of points along u and along v.
PLACES = 64
# On a trimmed surface, BORDER samples are reserved for each sample of the grid next to the
# boundary. At most TRIALS grids are tried, until the samples of the grid and the reserved samples
# together are at least CLOSE times the requested count, and at most the count.
BORDER, CLOSE, TRIALS = 0.5, 0.95, 4
# Numbers of lines u = const from 1 − AROUND to 1 + AROUND times an estimate are tried. Numbers of
# lines whose errors are at most AS_GOOD times the least error count as equally good.
AROUND, AS_GOOD = 0.12, 1.005
# Half the diagonals of cells may exceed the requested distance by this factor, since the numbers of
# lines are integers.
SLACK = 1.02
# Chords that are equal when rounded to this number of decimals count as equal.
DIGITS = 9


@dataclass(frozen=True, eq=False)
class AlignedGrid:
    """Makes graded grids on a piece, from fundamental forms on a raster of parameters.

    `axes` are the intervals of u and v; the forms are evaluated at the midpoints of their
    subintervals. `piece` is the index of the piece in `space`.
    """

    space: Space
    piece: int
    geometry: OnSpline
    axes: tuple[Axis, Axis]
    forms: Forms

    @classmethod
    def of(cls, space: Space, piece: int) -> AlignedGrid:
        """Evaluate the forms of a piece on a raster of its parameters.

        Lines u = const or v = const where the forms jump are lines of the raster, too.
        """
        (geometry,) = space.pieces[piece].geometries(space.threads)
        axes = axes_with(geometry, (np.empty(0), np.empty(0)))
        forms = forms_on(geometry, axes)
        along_u, along_v = (breaks_along(geometry, axes, forms, k) for k in (0, 1))
        if len(along_u) or len(along_v):
            axes = axes_with(geometry, (along_u, along_v))
            forms = forms_on(geometry, axes)
        # The first form is converted from the unit of length of the spline to that of the space.
        forms[:3] *= (space.unit / (SCALE * geometry.spline.scale)) ** 2
        return cls(
            space,
            piece,
            geometry,
            axes,
            Forms(forms[3:6].copy(), forms[:3].copy(), (axes[0].widths, axes[1].widths)),
        )

    def steps(self, angle: float, distance: float) -> Steps:
        """Return the steps between the lines of a grid with as few samples as errors allow.

        Half the diagonal of each cell between neighbouring lines is at most `angle`, in radians, in
        normal space, and at most `distance`, scaled as in `Space`, in space.
        """
        return equal_steps(self.forms, angle, distance)

    def steps_for(self, count: float, distance: float) -> Steps:
        """Return the steps between the lines of a grid with `count` samples, for a scaled distance.

        The count includes samples outside the trim. Half the diagonals of cells in space are at
        most `distance` if the count suffices for that.
        """
        return steps_for_count(self.forms, count, distance)

    def grid_for(self, most: int, distance: float) -> Grid:
        """Return about the finest grid with at most `most` samples inside the trim.

        If one line in each part of both axes gives more samples, that grid is returned.

        Half the diagonal of each cell in space is at most the scaled `distance` if `most` samples
        suffice for that.
        """
        whole, grid = float(most), self.grid(self.steps_for(most, distance), most)
        if self.geometry.spline.trim is None:
            return grid
        for _ in range(TRIALS):
            # Samples outside the trim do not count. Gaps at its boundary are filled later.
            spare = len(grid) + BORDER * grid.border
            whole *= most / max(spare, 1.0)
            grid = self.grid(self.steps_for(whole, distance), int(whole))
            if CLOSE * most <= len(grid) + BORDER * grid.border <= most:
                break
        return grid if len(grid) <= most else self.grid(self.steps_for(most, distance), most)

    def grid(self, steps: Steps, most: int | None) -> Grid:
        """Return the grid whose lines are the given steps apart.

        If `most` is given, steps are scaled for at most that many samples on the whole domain;
        without a trim, samples between the lines raise their number to `most`.
        """
        lengths = [x.lengths(y) for x, y in zip(self.axes, steps.along, strict=True)]
        if most is None:
            numbers = [np.ceil(x).astype(np.int64) for x in lengths]
        else:
            numbers = self._numbers(steps, lengths, most)
        lines = [
            axis.lines(along, number)
            for axis, along, number in zip(self.axes, steps.along, numbers, strict=True)
        ]
        columns, rows = (x.ravel() for x in np.indices([len(x) for x in lines]))
        cells = np.column_stack([lines[0][columns], lines[1][rows]])
        if most is not None and len(cells) < most and self.geometry.spline.trim is None:
            between = self._between(lines, most - len(cells))
            cells = np.concatenate([cells, between])
            columns, rows = (np.append(x, np.full(len(between), -1)) for x in (columns, rows))
        return self._at(cells, rows, columns, (len(lines[0]), len(lines[1])))

    def _numbers(self, steps: Steps, lengths: list[Array], most: int) -> list[Indices]:
        """Return the numbers of lines in the parts of both axes, whose lengths are given in steps.

        The lines have at most `most` crossings, unless one line in each part already gives more.
        The numbers are chosen for about the smallest error, see `_excess`.
        """
        total, found = float(lengths[0].sum()), []
        scale = math.sqrt(most / (total * float(lengths[1].sum())))
        low, high = (math.floor(scale * total * (1.0 + x)) for x in (-AROUND, AROUND))
        fewest = len(lengths[0])
        for number in range(max(low, fewest), max(high, fewest) + 1):
            numbers = [
                shared(x, n) for x, n in zip(lengths, (number, max(most // number, 1)), strict=True)
            ]
            scales = [x / n for x, n in zip(lengths, numbers, strict=True)]
            left = most - int(numbers[0].sum()) * int(numbers[1].sum())
            found.append((self._excess(steps, scales), left, numbers))
        least = min(excess for excess, _, _ in found)
        # Of nearly equal errors, choose the numbers of lines that leave the fewest samples unused.
        return min((x for x in found if x[0] <= AS_GOOD * least), key=lambda x: x[1])[2]

    def _excess(self, steps: Steps, scales: list[Array]) -> float:
        """Return the largest error of scaled steps, relative to the requested errors.

        It is the larger one of two ratios: of the angle to the requested angle, and of the distance
        to the requested distance. `scales` has for each axis an array of factors, one for each
        part.
        """
        along = [
            x * np.repeat(scale, np.diff(axis.breaks))
            for x, scale, axis in zip(steps.along, scales, self.axes, strict=True)
        ]
        a, b = along[0][:, None], along[1]
        aa, ab, bb = a * a, 2.0 * a * b, b * b
        squares = [
            float((e * aa + np.abs(f) * ab + g * bb).max())
            for e, f, g in (self.forms.third, self.forms.first)
        ]
        angle, distance = (math.sqrt(x) / 2.0 for x in squares)
        return max(angle / steps.angle, distance / (SLACK * steps.distance))

    def _between(self, lines: list[Array], number: int) -> Array:
        """Return midpoints between neighbours on the grid, the largest angles first.

        The midpoints are given in cells of the spline. The angles are measured between the normals
        of neighbours. Only neighbours along the parameter with the shorter distance in space are
        considered: a sample between neighbours along the other parameter would be the nearest one,
        in space, to points of other rows.
        """
        places, chords = [], []
        for axis in (0, 1):
            found = self._middles(lines, axis)
            closer = found[1][0] <= found[1][1]
            places.append(found[0][closer])
            chords.append(found[2][closer])
        order = np.argsort(-np.concatenate(chords).round(DIGITS), kind="stable")
        return np.concatenate(places)[order[:number]]

    def _middles(self, lines: list[Array], axis: int) -> tuple[Array, Array, Array]:
        """Return the midpoints (k, 2) between neighbours along parameter `axis`, 0 or 1.

        The midpoints are given in cells of the spline. Also return distances in space (2, k), of
        neighbours along this parameter and along the other one; and the chords (k,) between the
        normals of neighbours along this parameter.
        """
        steps = [np.gradient(x) if len(x) > 1 else np.full(1, np.inf) for x in lines]
        steps[axis] = np.diff(lines[axis])
        middles = list(lines)
        middles[axis] = (lines[axis][1:] + lines[axis][:-1]) / 2.0
        near = [
            np.clip(np.searchsorted(x.edges, y) - 1, 0, len(x.edges) - 2)
            for x, y in zip(self.axes, middles, strict=True)
        ]
        forms = self.forms.third, self.forms.first
        third, first = (x[:, near[0][:, None], near[1]] for x in forms)
        along, across = (np.broadcast_to(x, first[0].shape) for x in (
            steps[0][:, None], steps[1]
        ))  # fmt: skip
        lengths = [np.sqrt(first[0]) * along, np.sqrt(first[2]) * across]
        chord = np.sqrt(third[2 * axis]) * (along, across)[axis]
        cells = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 2)
        distances = np.stack([lengths[axis].ravel(), lengths[1 - axis].ravel()])
        return cells, distances, chord.ravel()

    def _at(self, cells: Array, rows: Indices, columns: Indices, lines: tuple[int, int]) -> Grid:
        """Return the grid of the positions `cells` (N, 2) that are inside the trim."""
        piece, frame = self.space.pieces[self.piece], self.geometry.spline.frame
        uv = frame[:2] + frame[2:] * cells
        inside = piece.contains(uv)
        made = self.space.at(np.full(int(inside.sum()), self.piece), uv[inside], keep=True)
        return Grid(made, rows[inside], columns[inside], lines)


def axes_with(geometry: OnSpline, breaks: tuple[Array, Array]) -> tuple[Axis, Axis]:
    """Return the axes of u and v, cut into about `PLACES` subintervals, and at the given breaks."""
    (m, n), (along_u, along_v) = geometry.spline.cells, breaks
    return Axis.of(float(m), PLACES, along_u), Axis.of(float(n), PLACES, along_v)


def forms_on(geometry: OnSpline, axes: tuple[Axis, Axis]) -> Array:
    """Return the fundamental forms (7, k, l) at the midpoints of a raster.

    They are E, F, G, e, f, g and D of `OnSpline.forms`. The unit of parameters is a cell of the
    spline.
    """
    u, v = (x.middles for x in axes)
    cells = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    return geometry.forms(cells).T.reshape(7, len(u), len(v))


def shared(lengths: Array, number: int) -> Indices:
    """Divide a number of lines among parts, at least one line for each part.

    Each further line goes to the part where the lines are the farthest apart.
    """
    numbers = np.ones(len(lengths), dtype=np.int64)
    if number > len(lengths):
        numbers += np.floor(lengths * ((number - len(lengths)) / lengths.sum())).astype(np.int64)
    while numbers.sum() < number:
        numbers[np.argmax(lengths / numbers)] += 1
    return numbers
