"""A CAD file before Open CASCADE reads it: its content, and the part files of an assembly.

Open CASCADE silently ignores part files that are missing or truncated. Therefore all part files are
checked and copied to one folder, and references to them are renamed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ...runtime.base.wording import plural
from ..files.paths import reason_of
from ..files.reading import UnusableError, regular_file
from .damaged_step import COMMENT, ENTITY, LostFace, without_damaged_faces
from .inspection import checked_format, faces_said

COPY = "copy.step"
# Open CASCADE takes the name of a part file from the identification assigned to a document, or from
# the document.
DOCUMENT = b"DOCUMENT_FILE"
ASSIGNED = b"APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT"
STEP_SUFFIXES = (".step", ".stp", ".p21")
TEXT = re.compile(rb"'((?:[^']|'')*)'")
REFERENCE = re.compile(rb"#(\d+)")
# Some of the escape sequences of characters in STEP strings (ISO 10303-21): \X2\, \X\, \\ and ''.
ESCAPED = re.compile(r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\|\\X\\([0-9A-F]{2})|\\\\|''", re.IGNORECASE)
# The largest number of unreadable part files that a sentence names.
MOST_NAMED = 3


@dataclass
class PartFiles:
    """The part files of an assembly, at all levels, copied to a folder.

    `copies` are the names of the copies, by path, and `unreadable` the reasons why files are not
    readable, by name. `lost` are the faces that were left out of the copies, and `faces` is the
    number of faces in the copies.
    """

    folder: Path
    copies: dict[str, str] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)
    lost: list[LostFace] = field(default_factory=list)
    faces: int = 0

    def renamed(self, content: bytes, path: Path, above: tuple[str, ...] = ()) -> bytes:
        """Copy the part files that a STEP file names; return the STEP file with the new names."""
        entities = _references(content)
        if not entities:
            return content
        above = (*above, os.path.realpath(path))
        found = {x: self._copied(x, path, above) for x in set(entities.values())}
        new = {k: found[name] for k, name in entities.items()}

        def rewritten(match: re.Match[bytes]) -> bytes:
            name = new.get(int(match[1]))
            if name is None:
                return match[0]
            return match[0].replace(match[2], TEXT.sub(b"'%s'" % name.encode(), match[2], count=1))

        return ENTITY.sub(rewritten, COMMENT.sub(b"", content))

    def _copied(self, name: str, parent: Path, above: tuple[str, ...]) -> str:
        """Copy a part file, and return the name of the copy; unreadable files are not copied."""
        folders = parent.parent, Path(os.path.realpath(parent)).parent
        path = next((x / name for x in folders if (x / name).exists()), folders[0] / name)
        real = os.path.realpath(path)
        if real in above:
            self.unreadable[name] = "refers to itself"
            return "absent-" + COPY
        if real in self.copies:
            return self.copies[real]
        # No file of this name is in the working folder, where Open CASCADE looks next.
        copy = self.copies[real] = f"gaussmap-{len(self.copies)}-{COPY}"
        try:
            content, lost = _checked_part(path)
        except UnusableError as error:
            self.unreadable[name] = str(error).rstrip(".")
        except OSError as error:
            lacks = isinstance(error, FileNotFoundError)
            self.unreadable[name] = "does not exist" if lacks else f"({reason_of(error)})"
        else:
            self.lost.extend(lost)
            self.faces += faces_said(content, "STEP")
            (self.folder / copy).write_bytes(self.renamed(content, path, above))
        return copy

    def said(self) -> str:
        """Return how many part files are missing or unreadable, and which; "" if none is."""
        if not self.unreadable:
            return ""
        bad = [f"'{name}' {why}" for name, why in sorted(self.unreadable.items())]
        if len(bad) > MOST_NAMED:
            bad[MOST_NAMED:] = [f"and {len(bad) - MOST_NAMED} more"]
        count = f"{len(self.unreadable)} of {plural(len(self.copies), 'part file')}"
        return f"{count} cannot be read: {'; '.join(bad)}"


@dataclass(frozen=True)
class Source:
    """A file to read: its format, its content, its part files, and the faces left out of it.

    `folder` is for temporary copies.
    """

    path: Path
    folder: Path
    format: str
    content: bytes
    lost: tuple[LostFace, ...] = ()
    parts: PartFiles | None = None

    def without(self, damaged: Mapping[int, str]) -> Source | None:
        """Return the STEP file without its damaged faces; None if no face is damaged.

        `damaged` has the reason for each unreadable entity, by its number.
        """
        content, lost = without_damaged_faces(self.content, damaged)
        return replace(self._with(content), lost=self.lost + lost) if lost else None

    def faces_said(self) -> int:
        """Return the number of distinct faces in all files, or a lower bound."""
        own = faces_said(self.content, self.format) + len(self.lost)
        return own + (self.parts.faces if self.parts else 0)

    def _with(self, content: bytes) -> Source:
        path = self.folder / COPY
        path.write_bytes(content)
        return replace(self, path=path, content=content)


def prepared(path: Path, folder: Path) -> Source:
    """Check a file, copy its part files, and return the source that Open CASCADE reads.

    Raises UnusableError with the reason if the file is unusable.
    """
    content = path.read_bytes()
    form, finite = checked_format(content)
    source = Source(path, folder, form, content)
    parts = PartFiles(folder)
    if form == "STEP" and (renamed := parts.renamed(content, path)) is not content:
        source = replace(source._with(renamed), parts=parts, lost=tuple(parts.lost))
    return source if finite else source.without({}) or source


def _checked_part(path: Path) -> tuple[bytes, tuple[LostFace, ...]]:
    """Return the content of a part file without its damaged faces, and a list of these faces."""
    with regular_file(path) as file:
        content = file.read()
    if checked_format(content)[0] != "STEP":
        raise UnusableError("is not a STEP file.")
    return without_damaged_faces(content, {})


def _references(content: bytes) -> dict[int, str]:
    """Return the names of part files, by the number of the entity that contains the name."""
    if DOCUMENT not in content:
        return {}
    bodies = {int(k): body for k, body in ENTITY.findall(COMMENT.sub(b"", content))}
    names = {k: _text(x) for k, x in bodies.items() if x.lstrip().startswith(DOCUMENT)}
    holders = {k: k for k in names}
    for k, body in bodies.items():
        if body.lstrip().startswith(ASSIGNED) and (name := _text(body)):
            for document in map(int, REFERENCE.findall(TEXT.sub(b"", body))):
                if document in names:
                    names[document], holders[document] = name, k
    return {holders[k]: x for k, x in names.items() if x.lower().endswith(STEP_SUFFIXES)}


def _text(body: bytes) -> str:
    """Return the first string of an entity, decoded."""
    found = TEXT.search(body)
    text = found[1].decode("utf-8", "surrogateescape") if found else ""

    def character(match: re.Match[str]) -> str:
        if match[1]:
            return bytes.fromhex(match[1]).decode("utf-16-be", "replace")
        return chr(int(match[2], 16)) if match[2] else match[0][0]

    return ESCAPED.sub(character, text)
