"""NumPy's .npz archives from anywhere: nothing is unpickled, and a small file stays small.

An archive may unpack to a thousand times its size, and the headers of its arrays may say anything.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .reading import UnusableError

__all__ = ["Archive", "archive_of"]

# An archive may unpack to so many bytes, or to so many times its own size. Arrays of numbers seldom
# shrink to a tenth; those that are not compressed do not at all.
HARMLESS, MOST_TIMES = 256 << 20, 100
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


class Archive:
    """The arrays of an archive, read one by one.

    Attributes
    ----------
    names : tuple of str
        The names of the arrays.
    unpacked : int
        The bytes of all of them. None is read beyond what its entry says.

    """

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        self._members = {
            member.filename.removesuffix(".npy"): member
            for member in archive.infolist()
            if member.filename.endswith(".npy")
        }
        self.names = tuple(self._members)
        self.unpacked = sum(member.file_size for member in self._members.values())

    def read(self, name: str) -> NDArray[Any]:
        """Return an array; UnusableError if it holds no numbers, or not as many as it says."""
        member = self._members[name]
        with self._archive.open(member) as stream:
            version = npy.read_magic(stream)
            if version not in HEADERS:  # only arrays with fields of many names have a newer one
                raise UnusableError(f"is damaged: {member.filename!r} is no array of numbers.")
            shape, _, dtype = HEADERS[version](stream)
            size = int(np.prod(shape, dtype=object)) * dtype.itemsize
            if dtype.hasobject or size > member.file_size:
                raise UnusableError(f"is damaged: {member.filename!r} is no array of numbers.")
        with self._archive.open(member) as stream:
            return npy.read_array(stream, allow_pickle=False)


@contextmanager
def archive_of(file: BufferedReader) -> Iterator[Archive]:
    """Yield the archive in a file; UnusableError if it is none, or would unpack to too much."""
    # NumPy would take what is no archive for a pickle.
    if not zipfile.is_zipfile(file):
        raise UnusableError("is damaged or is no .npz file; write it again.")
    packed = file.seek(0, 2)
    file.seek(0)
    with zipfile.ZipFile(file) as archive:
        arrays = Archive(archive)
        if arrays.unpacked > max(HARMLESS, MOST_TIMES * packed):
            raise UnusableError(
                f"has {packed / 1e6:,.1f} MB, and would unpack to {arrays.unpacked / 1e6:,.0f} MB, "
                f"more than {MOST_TIMES} times as much; if you trust it, write it again by "
                "numpy.savez, which does not compress."
            )
        yield arrays
