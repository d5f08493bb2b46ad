"""The quotient (x − p) / r of a spline x beside a side r = 0 that is collapsed to the point p.

On the knot spans next to the side, the numerators of x − p are polynomials in r without a constant
term; divided by r, they are polynomials as well. All operations of a tape after the spline must be
linear in its coordinates: division by the weight, rotation, and translation.
"""

from math import comb

import numpy as np

from ...generated import elementary as codes
from ..base.aliases import Array
from ..tape.kernels.functions import UNIT
from ..tape.kernels.points import Tape
from ..tape.kernels.spline_bounds import SLACK
from ..tape.kernels.splines import COORDINATES, Polynomials
from ..tape.tapes import BINARY, LEAVES, TapeWriter, moved_tape

# A side counts as collapsed if its coefficients differ by at most this many roundings of the
# largest one.
ROUNDINGS = 2.0**10


def spline_quotient(tape: Tape, angle: int, end: float, inward: float) -> tuple[Tape, float] | None:
    """Return the tape of (x − p) / r, and the largest r for which it is valid.

    `angle` is the index of the parameter of the spline that remains, 0 for u and 1 for v; the other
    one is end + inward · r. The result is None if the side r = 0 of the spline is not collapsed, or
    if an operation other than the spline depends on r.
    """
    (row,) = np.nonzero(tape.operations[:, 0] == codes.SPLINE)
    turned, total = int(tape.operations[row[0], 3]), tuple(tape.numbers[row[0]].tolist())
    if (tape.operations[:, 0] == (codes.V if angle == 0 else codes.U)).any():
        return None
    if turned and angle == 1:
        end, inward = total[0] - end, -inward
    is_rational = bool((tape.operations[:, 0] == codes.RECIPROCAL).any())
    found = _quotients(tape.spline, 1 - angle, end, inward, is_rational)
    if found is None:
        return None
    writer = TapeWriter()
    number = total if turned and angle == 0 else (0.0, 0.0)
    first = writer.spline(found[0], turned if angle == 0 else 0, number)
    outputs = _replayed(writer, tape, first, is_rational)
    quotient = None if outputs is None else writer.tape(outputs)
    return None if quotient is None else (quotient, found[1])


def _quotients(
    spline: Polynomials, axis: int, end: float, inward: float, is_rational: bool
) -> tuple[Polynomials, float] | None:
    """Return the polynomials of (x − p) / r, and the largest r at which they are valid.

    They are valid in the knot span next to the side r = 0. The parameter of the given axis is
    end + inward · r.
    """
    breaks, frames = (spline.breaks_u, spline.breaks_v)[axis], (spline.frames_u, spline.frames_v)
    at = 0 if inward > 0.0 else -1
    if not abs(breaks[at] - end) <= SLACK * np.abs(breaks[[0, -1]]).sum():
        return None
    middle, scale = frames[axis][at].tolist()
    place = (float(breaks[at]) - middle) * scale
    off = 4.0 * UNIT * (abs(end) + abs(middle)) * scale
    # The coefficients (spans, p + 1, q + 1, 4) next to the side; the third index is the power of r.
    table, errors = (
        np.take(x, at, axis=axis) if axis == 1 else np.take(x, at, axis=0).swapaxes(1, 2)
        for x in (spline.coefficients, spline.errors)
    )
    table, errors = _expanded(table, errors, place, off, inward)
    weights = table[..., 3] if is_rational else np.zeros_like(table[..., 3])
    one = np.zeros_like(weights[:, :, :1])
    one[:, 0] = 1.0
    weight = weights[:, :, :1] if is_rational else one
    point = table[0, 0, 0, :3] / weight[0, 0, 0]
    rest = table[:, :, 0, :3] - point * weight
    if not np.abs(rest).max() <= ROUNDINGS * UNIT * np.abs(table[..., :3]).max():
        return None
    found, of_found = np.zeros_like(table), np.zeros_like(errors)
    more = weights[:, :, 1:, None] * point
    found[:, :, :-1, :3] = scale * (table[:, :, 1:, :3] - more)
    sizes = np.abs(table[:, :, 1:, :3]) + np.abs(more)
    of_found[:, :, :-1, :3] = scale * (
        errors[:, :, 1:, :3] + np.abs(point) * errors[:, :, 1:, 3:] + 4.0 * UNIT * sizes
    )
    found[..., 3], of_found[..., 3] = table[..., 3], errors[..., 3]
    length = abs(float(breaks[1] - breaks[0] if at == 0 else breaks[-1] - breaks[-2]))
    return _as_polynomials(spline, axis, (found, of_found), scale, length), length


def _expanded(
    table: Array, errors: Array, place: float, off: float, inward: float
) -> tuple[Array, Array]:
    """Return the coefficients of the powers of inward · (s − place), with bounds of their errors.

    `table` has the coefficients of the powers of s along the last axis but one, `errors` bounds of
    their errors. The error of `place` is at most `off`.
    """
    degree = table.shape[2] - 1
    shift, sizes, slopes = np.zeros((3, degree + 1, degree + 1))
    for k in range(degree + 1):
        for b in range(k, degree + 1):
            shift[k, b] = comb(b, k) * place ** (b - k) * inward**k
            sizes[k, b] = comb(b, k) * abs(place) ** (b - k)
            slopes[k, b] = (b - k) * comb(b, k) * max(abs(place), off) ** max(b - k - 1, 0)
    own = errors + (4.0 * degree + 8.0) * UNIT * np.abs(table)
    moved = np.einsum("kb,lpbc->lpkc", 2.0 * off * slopes, np.abs(table))
    return (
        np.einsum("kb,lpbc->lpkc", shift, table),
        (np.einsum("kb,lpbc->lpkc", sizes, own) + moved) * (1.0 + 2.0**-40),
    )


def _as_polynomials(
    spline: Polynomials, axis: int, tables: tuple[Array, Array], scale: float, length: float
) -> Polynomials:
    """Return `Polynomials` with the given tables: the coefficients, and bounds of their errors.

    The first parameter is the parameter of `spline` whose index is not `axis`. The second one is r,
    with the single span [0, length]; the coefficients are those of powers of scale · r.
    """
    table, errors = (np.ascontiguousarray(x[:, None]) for x in tables)
    if axis == 1:
        breaks, smooth, frames = spline.breaks_u, spline.smooth_u, spline.frames_u
    else:
        breaks, smooth, frames = spline.breaks_v, spline.smooth_v, spline.frames_v
    periods = np.stack([spline.periods[1 - axis], np.zeros(2)])
    return Polynomials(
        breaks, np.array([0.0, length]), smooth, np.array([-1, -1]),
        frames, np.array([[0.0, scale]]), periods, table, errors,
    )  # fmt: skip


def _replayed(writer: TapeWriter, tape: Tape, first: int, is_rational: bool) -> list[int] | None:
    """Copy the operations of a tape to `writer`, with other coordinates of the spline.

    The rows of `writer` from `first` on replace the coordinates. Constants that are added to
    coordinates are left out. Return the rows of the outputs; None if the outputs are not linear in
    the coordinates.
    """
    rows: list[int] = []
    linear: list[bool] = []
    for (code, a, b, last), number in zip(
        tape.operations.tolist(), map(tuple, tape.numbers.tolist()), strict=True
    ):
        is_linear = code not in LEAVES and (linear[a] or (code in BINARY and linear[b]))
        if code in (codes.SPLINE, codes.COORDINATE):
            coordinate = 0 if code == codes.SPLINE else last
            rows.append(first + coordinate)
            linear.append(not is_rational or coordinate < COORDINATES - 1)
            continue
        if is_linear:
            both = code in BINARY and linear[a] == linear[b]
            if code > codes.PRODUCT or both != (code == codes.SUM):
                return None
        if is_linear and code == codes.SHIFT:
            rows.append(rows[a])
        elif code in (codes.U, codes.V):
            rows.append(writer.write("u"))
        else:
            other = rows[b] if code in BINARY else 0
            of_a = 0 if code in LEAVES else rows[a]
            rows.append(writer.row(code, of_a, other, last, number))
        linear.append(is_linear)
    return [rows[x] for x in tape.outputs] if all(linear[x] for x in tape.outputs) else None


def mapped_spline(tape: Tape, matrix: Array) -> Tape | None:
    """Return the tape of matrix · x, for a tape x of `spline_quotient`; None if it is not finite.

    If possible, the matrix is applied to the coefficients of the polynomials: sums of rows of the
    tape would have wider bounds.
    """
    found = _linear_form(tape)
    if found is None:
        return moved_tape(tape, matrix, np.zeros(3), None)
    own, factor = found
    (row,) = np.nonzero(tape.operations[:, 0] == codes.SPLINE)
    table, errors = tape.spline.coefficients.copy(), tape.spline.errors.copy()
    given, sizes = table[..., :3], np.abs(matrix) @ np.abs(own)
    errors[..., :3] = errors[..., :3] @ sizes.T + 16.0 * UNIT * (np.abs(given) @ sizes.T)
    errors[..., :3] *= 1.0 + 2.0**-40
    table[..., :3] = given @ (matrix @ own).T
    writer = TapeWriter()
    first = writer.spline(
        tape.spline._replace(coefficients=table, errors=errors),
        int(tape.operations[row[0], 3]),
        (float(tape.numbers[row[0], 0]), float(tape.numbers[row[0], 1])),
    )
    rows = [first, first + 1, first + 2]
    if factor is not None:
        inverse = writer.write("reciprocal", first + COORDINATES - 1)
        rows = [writer.write("product", x, inverse) for x in rows]
    return writer.tape(rows)


def _linear_form(tape: Tape) -> tuple[Array, int | None] | None:
    """Return the matrix by which the outputs depend on x, y, z; None if they are not linear.

    The second result is the row of the inverse weight by which the outputs are multiplied, or None
    if they are not multiplied by it.
    """
    forms: list[tuple[Array, int | None] | None] = []
    for row, (code, a, b, last) in enumerate(tape.operations.tolist()):
        number, distance = tape.numbers[row].tolist()
        x, y = forms[a] if a < row else None, forms[b] if b < row else None
        form = None
        if code in (codes.SPLINE, codes.COORDINATE):
            coordinate = 0 if code == codes.SPLINE else last
            form = (np.eye(3)[coordinate], None) if coordinate < COORDINATES - 1 else None
        elif code == codes.PRODUCT:
            (line, divided), weight = (x, b) if x is not None else (y or (None, None), a)
            is_inverse = tape.operations[weight, 0] == codes.RECIPROCAL
            form = (line, weight) if line is not None and divided is None and is_inverse else None
        elif code == codes.SUM and x is not None and y is not None and x[1] == y[1]:
            form = x[0] + y[0], x[1]
        elif code == codes.NEGATIVE and x is not None:
            form = -x[0], x[1]
        elif code == codes.SCALE and x is not None and distance == 0.0:
            form = number * x[0], x[1]
        forms.append(form)
    found = [forms[k] for k in tape.outputs]
    lines = [x for x in found if x is not None]
    if len(lines) < 3 or len({factor for _, factor in lines}) > 1:
        return None
    return np.stack([line for line, _ in lines]), lines[0][1]
