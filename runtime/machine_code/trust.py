"""Write access to files and folders of machine code: code that others can write is not run."""

import os
import stat
from pathlib import Path

OTHERS = stat.S_IWGRP | stat.S_IWOTH


def is_private(found: os.stat_result) -> bool:
    """Return whether nobody but the user, root and the owner of this package can write a file."""
    return _is_owned(found) and (os.name == "nt" or not found.st_mode & OTHERS)


def is_as_safe_as_sources(path: Path) -> bool:
    """Return whether everyone who can write a file of the package can also write its sources."""
    found, own = path.stat(), Path(__file__).stat()
    more = found.st_mode & OTHERS & ~own.st_mode
    other_group = bool(found.st_mode & stat.S_IWGRP) and found.st_gid != own.st_gid
    return os.name == "nt" or (_is_owned(found) and not more and not other_group)


def private_content(path: Path) -> bytes | None:
    """Return the content of a file; None if others can write it. OSError if it cannot be read."""
    place = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0))
    with open(place, "rb") as file:
        return file.read() if is_private(os.fstat(place)) else None


def _is_owned(found: os.stat_result) -> bool:
    if os.name == "nt":
        return True
    return found.st_uid in (os.geteuid(), 0, Path(__file__).stat().st_uid)
