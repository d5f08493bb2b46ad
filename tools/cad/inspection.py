"""The format of a CAD file, whether it is complete, and the number of faces that it states.

Files are inspected before Open CASCADE reads them: it reads the beginning of a truncated file
without complaint, and hangs on coordinates that are not finite.
"""

import re
import zipfile
from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES
from ..files.numpy_files import array_file
from ..files.reading import UnusableError

HEAD = 4096
START_OF_STEP = re.compile(rb"(?<!END-)ISO-10303-21\s*;")
END_OF_STEP = b"END-ISO-10303-21"
BREP = (b"DBRep_DrawableShape", b"CASCADE Topology V")
# Decimal exponents above 307, which are too large.
TOO_LARGE = rb"e\+?0*(?:30[89]|3[1-9]\d|[4-9]\d\d|\d{4,})"
SUSPICIOUS = re.compile(rb"nan|inf|" + TOO_LARGE)
NUMBER = rb"[-+]?(?:nan|inf(?:inity)?|\d*\.?\d*" + TOO_LARGE + rb")"
# Patterns of numbers that are not finite: in aggregates of STEP, lists of IGES and lines of BREP.
NOT_FINITE = {
    "STEP": re.compile(rb"[(,]\s*" + NUMBER + rb"\s*(?=[,)])", re.IGNORECASE),
    "IGES": re.compile(rb"[,;]\s*" + NUMBER + rb"\s*(?=[,;])", re.IGNORECASE),
    "BREP": re.compile(rb"(?<=\s)" + NUMBER + rb"(?=\s)", re.IGNORECASE),
}
SHAPES = re.compile(rb"^TShapes (\d+)\s*$", re.MULTILINE)
WHOLE = re.compile(rb"\s[-+]\d+ \d+[\s\d]*\Z")
TEXTS = re.compile(rb"'[^']*'")
SHELL = re.compile(
    rb"\b(?:CLOSED_SHELL|OPEN_SHELL|CONNECTED_FACE_SET)\s*\(\s*'[^']*'\s*,\s*\(([^()]*)\)"
)
REFERENCE = re.compile(rb"#\d+")
# The types of entities of IGES that are faces: bounded and trimmed surfaces, and faces of shells.
IGES_FACES = (b"143", b"144", b"510")
# Names of arrays in every part saved by gaussmap.
NAMES = {"about.npy", "face_loops.npy"}


def checked_format(content: bytes) -> tuple[str, bool]:
    """Return the format of a file, STEP, IGES or BREP, and whether all its numbers are finite.

    Raises UnusableError for damaged files; only STEP files may contain numbers that are not finite.
    """
    if not content.strip():
        raise UnusableError("is empty.")
    form = format_of(content[:HEAD])
    if form is None:
        raise UnusableError("is not a STEP, IGES or BREP file.")
    if form == "STEP" and END_OF_STEP not in content[-HEAD:]:
        raise UnusableError("is truncated: a STEP file ends with END-ISO-10303-21; get it again.")
    if form == "IGES":
        _check_iges(content)
    if form == "BREP":
        _check_brep(content)
    finite = _is_finite(content, form)
    if not finite and form != "STEP":
        raise UnusableError("holds numbers that are not finite; export it again.")
    return form, finite


def _is_finite(content: bytes, form: str) -> bool:
    if not SUSPICIOUS.search(content.lower()):
        return True
    if not NOT_FINITE[form].search(content):
        return True
    return form == "STEP" and not NOT_FINITE[form].search(TEXTS.sub(b"''", content))


def format_of(head: bytes) -> str | None:
    """Return STEP, IGES or BREP by the first bytes of a file; None if it is none of these."""
    if START_OF_STEP.search(head):
        return "STEP"
    if any(x in head for x in BREP):
        return "BREP"
    return "IGES" if _letters(head.splitlines()[:1]) == "S" else None


def _letters(lines: list[bytes]) -> str:
    """Return, for each line of an IGES file, the letter of its section, or "?" if it has none."""
    found = (x[72:73] for x in lines)
    letters = (x.decode() if x in (b"S", b"G", b"D", b"P", b"T") else "?" for x in found)
    return "".join(letters)


def _check_iges(content: bytes) -> None:
    """Raise UnusableError unless each section of an IGES file has the stated number of lines.

    The last line of the file states these numbers.
    """
    lines = [x for x in content.splitlines() if x.strip()]
    letters = _letters(lines)
    end = letters.find("T")
    if end < 0:
        raise UnusableError("is truncated: it lacks the last line of an IGES file; get it again.")
    said = dict(re.findall(r"([SGDP])\s*(\d+)", lines[end][:32].decode("ascii", "replace")))
    for letter in "SGDP":
        count = letters[:end].count(letter)
        if int(said.get(letter, count)) != count:
            raise UnusableError(
                f"is damaged: its last line says {said[letter]} lines of section {letter}, and it "
                f"has {count}; get it again."
            )


def _check_brep(content: bytes) -> None:
    """Raise UnusableError unless a BREP file has its last line, and each shape ends with a star."""
    start = SHAPES.search(content)
    whole = start is not None and WHOLE.search(content[-HEAD:])
    if start is None or not whole or content.count(b"*", start.end()) != int(start[1]):
        raise UnusableError("is truncated or damaged: it lacks shapes; save it again.")


def faces_said(content: bytes, form: str) -> int:
    """Return the number of distinct faces in a file, or a lower bound if it is uncertain."""
    if form == "STEP":
        return len({x for shell in SHELL.findall(content) for x in REFERENCE.findall(shell)})
    if form == "IGES":
        directory = [x for x in content.splitlines() if x[72:73] == b"D"]  # two lines an entity
        return sum(x[:8].strip() in IGES_FACES for x in directory[::2])
    return 0


def is_part_file(source: str | None) -> bool:
    """Return whether a text is the path of a file that holds a part.

    The suffix of the path, the first bytes of the file or the names of its arrays decide.

    Unlike this function, `read_cad` decides by the content of a file alone, whatever its suffix.
    """
    if source is None:
        return False
    suffix = Path(source).suffix.lower()
    if suffix in CAD_SUFFIXES:
        return True
    try:
        if not array_file(source).is_file():  # reading a pipe would block
            return False
        if suffix != ".npz":
            with open(source, "rb") as file:
                return format_of(file.read(HEAD)) is not None
        with zipfile.ZipFile(array_file(source)) as archive:
            return set(archive.namelist()) >= NAMES
    except (OSError, ValueError, zipfile.BadZipFile):
        return False
