"""CAD parts in files: STEP, IGES and BREP files, and .npz files that gaussmap saved."""

from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES
from ...runtime.base.errors import InputError, shown
from ..cad.inspection import is_part_file
from ..cad.part import Part, read_part
from .named import Named

# The options of `read_cad`.
LIMITS = ("unit", "time_limit", "memory_limit")
# The options of `Part.select`.
OF_FACES = ("kind", "name", "faces")


def read_part_file(named: Named) -> Part:
    """Read a part, and select the faces that the options describe.

    Raises the errors of `read_cad`, `read_part` and `Part.select`, InputError for other files.
    """
    part = _read(named)
    if not {*OF_FACES} & {*named.given()}:
        return part
    try:
        index = None if named.faces is None else [int(x) for x in named.faces.split(",")]
    except ValueError:
        raise InputError(
            f"--faces takes indices of faces, as in --faces 3 7, not {shown(named.faces)}."
        ) from None
    return part.select(kind=named.kind or None, name=named.name, index=index)


def _read(named: Named) -> Part:
    source = named.surface or ""
    if Path(source).suffix.lower() == ".npz":
        named.refuse(LIMITS, "is for STEP, IGES and BREP files, and {} is none.")
        return read_part(source)
    if not is_part_file(source):
        raise InputError(
            f"'{source}' is no STEP, IGES or BREP file ({', '.join(CAD_SUFFIXES)}), and no .npz "
            "file of a part that gaussmap saved."
        )
    from ..cad.reader import read_cad

    given = {name: value for name, value in named.given().items() if name in LIMITS}
    return read_cad(source, **given, progress=not named.quiet)
