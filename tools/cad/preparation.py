"""A file before Open CASCADE reads it: looked at, and copied without its damaged faces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from .damaged_step import LostFace, without_damaged_faces
from .inspection import checked_format

__all__ = ["Source", "prepared"]

COPY = "copy.step"


@dataclass(frozen=True)
class Source:
    """A file to read: its format, its content, and the faces that have been left out of it.

    `folder` is for copies.
    """

    path: Path
    folder: Path
    format: str
    content: bytes
    lost: tuple[LostFace, ...] = ()

    def without(self, damaged: Mapping[int, str]) -> Source | None:
        """Return a STEP file without its damaged faces, or None if it has none.

        `damaged` has numbers of entities that cannot be read, with reasons.
        """
        content, lost = without_damaged_faces(self.content, damaged)
        if not lost:
            return None
        path = self.folder / COPY
        path.write_bytes(content)
        return replace(self, path=path, content=content, lost=self.lost + lost)


def prepared(path: Path, folder: Path) -> Source:
    """Return what is to be read of a file; BadFileError says why nothing is."""
    content = path.read_bytes()
    form, finite = checked_format(content)
    source = Source(path, folder, form, content)
    return source if finite else source.without({}) or source
