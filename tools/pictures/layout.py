"""The layout of a picture in inches, and the texts in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "HEIGHT",
    "LEFT",
    "LEGENDS",
    "MIDDLE",
    "RADIUS",
    "RIGHT",
    "ROOM_HEIGHT",
    "ROOM_WIDTH",
    "TITLES",
    "WIDTH",
    "box",
    "write",
]

# The centres of both halves, and the size of their contents.
WIDTH, HEIGHT, MIDDLE, TITLES, LEGENDS = 9.0, 4.9, 2.45, 4.17, 0.56
LEFT, ROOM_WIDTH, ROOM_HEIGHT = 2.4, 4.1, 3.1
RIGHT, RADIUS = 6.8, 1.35


def write(figure: Figure, x: float, y: float, text: str, **style: Any) -> None:  # noqa: ANN401
    """Write a text at a position in inches; dollar signs in it are not mathematics."""
    figure.text(x / WIDTH, y / HEIGHT, text, ha="center", parse_math=False, **style)


def box(x: float, y: float, width: float, height: float) -> tuple[float, float, float, float]:
    """Return a rectangle, given by its centre and size in inches, in fractions of the figure."""
    return (x - width / 2) / WIDTH, (y - height / 2) / HEIGHT, width / WIDTH, height / HEIGHT
