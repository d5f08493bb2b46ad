"""Tapes of surfaces in polar coordinates at a pole, and of their derivatives by the angle."""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass

from ...generated import elementary
from ..base.formula_calls import python_function
from ..domain.domain import Domain
from ..kernels.tape import Tape
from .tapes import TapeWriter
from .traced import Traced

__all__ = ["PolarTapes", "polar_tapes"]

NAMES = {code: name.lower() for name, code in vars(elementary).items() if isinstance(code, int)}
PARTNERS = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}

Slope = Traced | float  # the number 0.0 where a row does not depend on the angle


@dataclass(frozen=True)
class PolarTapes:
    """The tapes of x(φ, r) and of x_φ, with φ and r in place of u and v."""

    position: Tape
    slope: Tape


def polar_tapes(tape: Tape, domain: Domain, angle: int, end: float) -> PolarTapes | None:
    """Return the tapes at a pole; None for splines, and for numbers that are not finite.

    Parameter number `angle` runs around it, the other one is `end` there: φ = 0 … 2π, r = 0 … .
    """
    if (tape.operations[:, 0] == elementary.SPLINE).any():
        return None
    writer = TapeWriter()
    phi, r = (Traced(writer, writer.write(x)) for x in "uv")
    low, high = domain[angle]
    turn = (high - low) / (2.0 * math.pi)
    factor = Traced(writer, writer.constant(turn, 4.0 * math.ulp(turn)))
    inward = 1.0 if end == domain[1 - angle][0] else -1.0
    around, away = phi * factor + low, r * inward + end
    values = [around, away] if angle == 0 else [away, around]
    slopes = [factor, 0.0] if angle == 0 else [0.0, factor]
    rows = _with_slopes(writer, tape, values, slopes)
    zero = Traced(writer, writer.constant(0.0))
    position = writer.tape([rows[x][0].row for x in tape.outputs])
    slope = writer.tape([(rows[x][1] + zero).row for x in tape.outputs])
    return None if position is None or slope is None else PolarTapes(position, slope)


def _with_slopes(
    writer: TapeWriter, tape: Tape, variables: list[Traced], slopes: list[Slope]
) -> list[tuple[Traced, Slope]]:
    """Return the values of the rows of a tape and their derivatives, 0.0 for those of constants."""
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
    """Return a function of a row, and its derivative by the chain rule."""
    value = Traced(writer, writer.write(name, x.row))
    if isinstance(slope, float):
        return value, 0.0
    given = {"x": x, "y": value}
    if name in PARTNERS:
        given["w"] = Traced(writer, writer.write(PARTNERS[name], x.row))
    formula = python_function(getattr(elementary, f"{name}_taylor"))
    first = formula(*(given[z] for z in inspect.signature(formula).parameters))[0]
    return value, first * slope
