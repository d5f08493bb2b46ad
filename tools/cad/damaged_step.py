"""Damaged faces of STEP files: finding them, and removing them from the file.

A face that refers to a missing entity, or to numbers that are not finite, would become an infinite
plane, or make Open CASCADE hang. The other faces can be read.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ..files.reading import UnusableError
from .inspection import NOT_FINITE, TEXTS

COMMENT = re.compile(rb"/\*.*?\*/", re.DOTALL)
ENTITY = re.compile(rb"#(\d+)\s*=\s*((?:'[^']*'|[^';])*);")
REFERENCE = re.compile(rb"#(\d+)")
FACES = (b"ADVANCED_FACE", b"FACE_SURFACE")
SHELLS = (b"CLOSED_SHELL", b"OPEN_SHELL", b"CONNECTED_FACE_SET")
FIRST_TEXT = re.compile(rb"'([^']*)'")


@dataclass(frozen=True)
class LostFace:
    """A face that was left out: its name, or its entity number in the file, and the reason."""

    name: str
    reason: str


def numbers_of_entities(content: bytes) -> list[int]:
    """Return the numbers of all entities, in the order of the file."""
    return [int(number) for number, _ in ENTITY.findall(COMMENT.sub(b"", content))]


def without_damaged_faces(
    content: bytes, damaged: Mapping[int, str]
) -> tuple[bytes, tuple[LostFace, ...]]:
    """Return the content of a STEP file without its damaged faces, and a list of these faces.

    `damaged` gives the reason for each entity that Open CASCADE cannot read, by its number in the
    file. Raises UnusableError for infinite or NaN coordinates that belong to no face.
    """
    content = COMMENT.sub(b"", content)
    bodies = {int(number): body for number, body in ENTITY.findall(content)}
    references = {k: _references(body) for k, body in bodies.items()}
    roots = {k: why for k, why in damaged.items() if k in bodies}
    not_finite = _not_finite(bodies)
    roots.update(not_finite)
    missing = {k: x for k, every in references.items() for x in every if x not in bodies}
    for k, x in missing.items():
        roots.setdefault(k, f"its #{k} refers to #{x}, which the file lacks")
    reached = _faces_above(roots, bodies, references)
    for k in not_finite:
        if not reached[k]:
            raise UnusableError(f"holds a number that is not finite, in #{k}; export it again.")
    shells = {k for k, body in bodies.items() if body.lstrip().startswith(SHELLS)}
    used = {x for k in shells for x in references[k]}
    faces = {face: roots[root] for root, found in reached.items() for face in found & used}
    lost = [LostFace(_name(k, bodies[k]), why) for k, why in sorted(faces.items())]
    absent = {x for k in shells & missing.keys() for x in references[k] if x not in bodies}
    lost += [LostFace(f"#{x}", "the file lacks it") for x in sorted(absent)]
    left_out = faces.keys() | absent
    touched = {k for k in shells if not left_out.isdisjoint(references[k])}

    def rewritten(match: re.Match[bytes]) -> bytes:
        number = int(match[1])
        if number not in touched:
            return match[0]
        kept = ",".join(f"#{x}" for x in references[number] if x not in left_out).encode()
        start = match[2].rindex(b"(")
        return b"#%d=%s(%s));" % (number, match[2][:start], kept)

    return (ENTITY.sub(rewritten, content) if touched else content), tuple(lost)


def _references(body: bytes) -> list[int]:
    if b"'" in body:
        body = TEXTS.sub(b"''", body)
    return [int(x) for x in REFERENCE.findall(body)]


def _not_finite(bodies: Mapping[int, bytes]) -> dict[int, str]:
    found = NOT_FINITE["STEP"]
    return {
        k: f"its #{k} holds a number that is not finite"
        for k, body in bodies.items()
        if found.search(body) and found.search(TEXTS.sub(b"''", body))
    }


def _faces_above(
    roots: Iterable[int], bodies: Mapping[int, bytes], references: Mapping[int, list[int]]
) -> dict[int, set[int]]:
    """Return, for each damaged entity (root), the set of faces that refer to it.

    A face may refer to a root directly or through other entities. Roots and faces are given by
    their entity numbers.
    """
    users: dict[int, list[int]] = {}
    for k, every in references.items():
        for x in every:
            users.setdefault(x, []).append(k)
    found: dict[int, set[int]] = {}
    for root in roots:
        faces, seen, left = set(), {root}, [root]
        while left:
            k = left.pop()
            if bodies[k].lstrip().startswith(FACES):
                faces.add(k)
                continue
            for user in users.get(k, ()):
                if user not in seen:
                    seen.add(user)
                    left.append(user)
        found[root] = faces
    return found


def _name(number: int, body: bytes) -> str:
    text = FIRST_TEXT.search(body)
    name = text[1].decode("ascii", "replace").strip() if text else ""
    return name if name not in ("", "NONE") else f"#{number}"
