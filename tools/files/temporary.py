"""Names of temporary files, by which those of processes that were killed are known and removed.

A name holds the machine, the process and when it began: a process of the same number that began at
another time is another one. Files of other machines that share the folder are left alone, and so is
everything where the system says nothing of processes.
"""

from __future__ import annotations

import os
import secrets
import shutil
import socket
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from pathlib import Path

__all__ = ["new_name", "remove_left"]

PREFIX = "gaussmap-"
PROCESSES = Path("/proc")


def new_name() -> str:
    """Return a new name, to which a dot may be prepended, and a suffix appended."""
    return f"{PREFIX}{_owner(os.getpid())}-{secrets.token_hex(4)}"


def remove_left(folder: Path) -> None:
    """Remove what processes of this machine that are gone have left in a folder.

    A process looks at a folder once: it may hold a million files.
    """
    with suppress(OSError):
        _remove_once(os.path.realpath(folder), os.getpid())


@cache
def _remove_once(folder: str, process: int) -> None:
    if not this_machine():
        return
    with os.scandir(folder) as entries:
        left = [entry for entry in entries if _is_left(entry.name) and _is_own(entry)]
    for entry in left:
        with suppress(OSError):
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                os.unlink(entry.path)


def _is_left(name: str) -> bool:
    name = name.removeprefix(".")
    parts = name.removeprefix(PREFIX).partition(".")[0].split("-")
    if not name.startswith(PREFIX) or len(parts) != 4:
        return False
    machine, process, began, _ = parts
    if machine != this_machine() or not (process.isdecimal() and began.isdecimal()):
        return False
    return began_at(int(process)) != began


def _is_own(entry: os.DirEntry[str]) -> bool:
    """Return whether it belongs to this user: processes of others may be hidden."""
    return entry.stat(follow_symlinks=False).st_uid == os.getuid()


def _owner(process: int) -> str:
    return f"{this_machine() or 'x'}-{process}-{began_at(process) or 'x'}"


def began_at(process: int) -> str:
    """Return when a process began, in ticks since the machine did; "" if there is no such one."""
    try:
        text = (PROCESSES / str(process) / "stat").read_text(errors="replace")
    except OSError:
        return ""
    return text.rpartition(")")[2].split()[19]  # the name before it may hold spaces


@cache
def this_machine() -> str:
    """Return a text for this machine, and for the container; "" if processes cannot be seen."""
    try:
        space = os.readlink(PROCESSES / "self" / "ns" / "pid")
    except OSError:
        return ""
    return blake2b(f"{socket.gethostname()} {space}".encode(), digest_size=6).hexdigest()
