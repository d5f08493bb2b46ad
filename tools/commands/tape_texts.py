"""Tapes as text: a line for each operation."""

from __future__ import annotations

from ...generated import elementary as codes
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import BINARY, LEAVES, NEUTRAL

__all__ = ["tape_text"]

NAMES = {code: name.lower() for name, code in vars(codes).items() if isinstance(code, int)}
NUMBERED = (codes.CONSTANT, *NEUTRAL)  # the operations that have a number


def tape_text(tape: Tape) -> str:
    """Return the rows of a tape as text: operation, rows of its arguments, and number."""
    width = len(str(len(tape.operations)))
    lines = []
    for row, (code, a, b, _) in enumerate(tape.operations.tolist()):
        words = [f"{row:{width}}  {NAMES[code]}"]
        words += [] if code in LEAVES else [f"[{a}]"]
        words += [f"[{b}]"] if code in BINARY else []
        value, distance = tape.numbers[row].tolist()
        words += [repr(value)] if code in NUMBERED else []
        words += [f"± {distance:.2g}"] if code in NUMBERED and distance > 0.0 else []
        lines.append(" ".join(words))
    outputs = (f"{x} = [{row}]" for x, row in zip("xyz", tape.outputs.tolist(), strict=True))
    return "\n".join([*lines, ", ".join(outputs)])
