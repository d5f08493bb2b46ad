"""Tapes of surfaces in polar coordinates at a pole, and of quotients that are finite there.

The polar coordinates are u, the parameter of the surface that runs around the pole, and r, the
distance of the other parameter from its value at the pole. The line r = 0 is collapsed to a point
p.
"""

import inspect
import math
from dataclasses import dataclass

from ...generated import elementary
from ..base.formula_calls import python_function
from ..surface.traced import Traced
from ..tape.kernels.points import Tape
from ..tape.tapes import TapeWriter
from .spline_quotient import spline_quotient

NAMES = {code: name.lower() for name, code in vars(elementary).items() if isinstance(code, int)}
PARTNERS = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}

Slope = Traced | float  # the number 0.0 if a row does not depend on the angle


@dataclass(frozen=True)
class PolarTapes:
    """Tapes of a surface in polar coordinates: those of x(u, r) and of its derivative x_u.

    For a spline, `tape` is that of (x − p) / r and `slope` is None. The tapes are valid for r ≤
    `most`.
    """

    tape: Tape
    slope: Tape | None
    most: float


def polar_tapes(tape: Tape, angle: int, end: float, inward: float) -> PolarTapes | None:
    """Return the tapes at a pole; None if they contain numbers that are not finite.

    `angle` is the index of the parameter that runs around the pole; the other parameter is
    end + inward · r, where `inward` is 1 or −1.
    """
    if (tape.operations[:, 0] == elementary.SPLINE).any():
        found = spline_quotient(tape, angle, end, inward)
        return None if found is None else PolarTapes(found[0], None, found[1])
    writer = TapeWriter()
    u, r = (Traced(writer, writer.write(x)) for x in "uv")
    values, slopes = [u, r * inward + end], [Traced(writer, writer.constant(1.0)), 0.0]
    step = 1 if angle == 0 else -1
    rows = _with_slopes(writer, tape, values[::step], slopes[::step])
    zero = Traced(writer, writer.constant(0.0))
    position = writer.tape([rows[x][0].row for x in tape.outputs])
    slope = writer.tape([(rows[x][1] + zero).row for x in tape.outputs])
    return None if position is None or slope is None else PolarTapes(position, slope, math.inf)


def _with_slopes(
    writer: TapeWriter, tape: Tape, variables: list[Traced], slopes: list[Slope]
) -> list[tuple[Traced, Slope]]:
    """Return the value of each row of a tape, and its derivative with respect to the angle."""
    rows: list[tuple[Traced, Slope]] = []
    for (code, a, b, _), (number, distance) in zip(
        tape.operations.tolist(), tape.numbers.tolist(), strict=True
    ):
        name = NAMES[code]
        constant = Traced(writer, writer.constant(number, distance))
        if name in ("u", "v"):
            rows.append((variables["uv".index(name)], slopes["uv".index(name)]))
        elif name == "constant":
            rows.append((constant, 0.0))
        elif name == "sum":
            rows.append((rows[a][0] + rows[b][0], rows[a][1] + rows[b][1]))
        elif name == "shift":
            rows.append((rows[a][0] + constant, rows[a][1]))
        elif name == "negative":
            rows.append((-rows[a][0], -rows[a][1]))
        elif name == "scale":
            rows.append((rows[a][0] * constant, rows[a][1] * constant))
        elif name == "product":
            (x, x1), (y, y1) = rows[a], rows[b]
            rows.append((x * y, x1 * y + x * y1))
        else:
            rows.append(_applied(writer, name, *rows[a]))
    return rows


def _applied(writer: TapeWriter, name: str, x: Traced, slope: Slope) -> tuple[Traced, Slope]:
    """Record the operation `name` of the row x on the tape; return its value and its derivative.

    `slope` is the derivative of the row x; the chain rule gives the derivative of the value.
    """
    value = Traced(writer, writer.write(name, x.row))
    if isinstance(slope, float):
        return value, 0.0
    given = {"x": x, "y": value}
    if name in PARTNERS:
        given["w"] = Traced(writer, writer.write(PARTNERS[name], x.row))
    formula = python_function(getattr(elementary, f"{name}_taylor"))
    first = formula(*(given[z] for z in inspect.signature(formula).parameters))[0]
    return value, first * slope
