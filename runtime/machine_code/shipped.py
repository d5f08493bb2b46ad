"""The file of machine code that comes with the package: `compiled/LEVEL.kernels`.

A wheel has the file for one level of processors, made by `building`. It is used if the sources of
kernels, the series of Numba, Python and the platform are those of the build, and the processor has
the level. Otherwise kernels are compiled here. The results are the same, bit for bit.

The file consists of `MAGIC`, the size of a header, the header (sealed JSON), and the entries that
it lists. It is read from the folder of the package only, and only if everybody who can write it can
also write the sources: machine code could do anything.
"""

import json
import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from numba.core import config as numba_config

from .entries import WORD, opened, replace_file, sealed
from .processors import changed_options, identity, level_here, runs_here
from .sources import PACKAGE, digest
from .trust import is_as_safe_as_sources

config: Any = numba_config  # Numba creates its attributes at run time
MAGIC = b"gaussmap kernels 2\n"
SWITCH = "GAUSSMAP_KERNELS"  # if it is 0, the file is neither built nor used


class Pack:
    """A file of machine code.

    Raises OSError if it cannot be read, ValueError if it is not such a file or its header is
    damaged.
    """

    def __init__(self, path: Path) -> None:
        content, start = path.read_bytes(), len(MAGIC) + WORD
        end = start + int.from_bytes(content[len(MAGIC) : start], "little")
        text = opened(content[start:end])
        if not content.startswith(MAGIC) or text is None:
            raise ValueError(f"{path} does not hold kernels of gaussmap")
        self.header: dict[str, Any] = json.loads(text)
        self._entries = content[end:]
        self.places: dict[str, tuple[int, int]] = self.header["places"]
        self.identity: dict[str, str] = self.header["identity"]
        self.digest: str = self.header["digest"]

    def get(self, key: str) -> bytes | None:
        """Return the entry with a key, possibly damaged, or None."""
        if key not in self.places:
            return None
        offset, size = self.places[key]
        return self._entries[offset : offset + size]


def pack_path(folder: Path = PACKAGE) -> Path | None:
    """Return the path of the file for this architecture; None if it has no level of processors."""
    level = level_here()
    return None if level is None else folder / "compiled" / f"{level.name}.kernels"


def write_pack(path: Path, entries: Mapping[str, bytes], **header: object) -> None:
    """Write a file of machine code; `entries` maps keys to entries."""
    places, offset = {}, 0
    for key, entry in entries.items():
        places[key] = (offset, len(entry))
        offset += len(entry)
    text = json.dumps({"identity": identity(), "digest": digest(), **header, "places": places})
    front = sealed(text.encode())
    path.parent.mkdir(parents=True, exist_ok=True)
    size = len(front).to_bytes(WORD, "little")
    replace_file(path, b"".join([MAGIC, size, front, *entries.values()]))


@cache
def open_pack() -> Pack | None:
    """Return the file of the package if its code runs here and was built from these sources."""
    pack = _pack_of_package()
    if pack is None or pack.identity != identity() or changed_options():
        return None
    level = level_here()
    fits = level is not None and runs_here(level) and pack.digest == digest()
    return pack if fits else None


def misfit() -> str:
    """Return the versions in the package's file that differ from the installed ones, as a text."""
    pack = _pack_of_package()
    if pack is None:
        return ""
    here = identity()
    others = [f"{name} {x}" for name, x in pack.identity.items() if here.get(name) != x]
    return ", ".join(others)


def _pack_of_package() -> Pack | None:
    path = pack_path()
    if path is None or config.DISABLE_JIT or os.environ.get(SWITCH) == "0":
        return None
    try:
        return Pack(path) if is_as_safe_as_sources(path) else None
    except (OSError, ValueError):  # missing, or damaged
        return None
