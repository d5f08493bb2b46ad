"""NumPy's .npz archives from untrusted sources: nothing is unpickled, and sizes are limited.

An archive may unpack to a thousand times its size, and headers of its arrays may be false.
"""

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .reading import UnusableError

# An archive may unpack to this many bytes, or to this many times its own size: numeric arrays
# seldom compress to a tenth, and uncompressed archives do not grow.
HARMLESS, MOST_TIMES = 256 << 20, 100


class Archive:
    """The arrays of an archive, read one by one.

    Attributes
    ----------
    names : tuple of str
        The names of the arrays.
    unpacked : int
        The total size of the arrays in bytes. No array is read beyond the size of its entry.

    """

    def __init__(self, archive: Any) -> None:  # noqa: ANN401 - NumPy's NpzFile
        self._archive = archive
        entries = archive.zip.infolist()
        names = [x.filename for x in entries if x.filename.endswith(".npy")]
        self.names = tuple(x.removesuffix(".npy") for x in names)
        self.unpacked = sum(x.file_size for x in entries)

    def read(self, name: str) -> NDArray[Any]:
        """Return an array; UnusableError if it is not numeric, or shorter than its header says."""
        try:
            found = self._archive[f"{name}.npy"]
        except (ValueError, MemoryError):  # raised for objects, and for shapes that are too large
            found = None
        if not isinstance(found, np.ndarray):
            raise UnusableError(f"is damaged: '{name}.npy' is no array of numbers.")
        return found


@contextmanager
def archive_of(file: BufferedReader) -> Iterator[Archive]:
    """Yield the archive in a file; UnusableError if it is not one, or would unpack to too much."""
    # NumPy would read any other file as a pickle.
    if not zipfile.is_zipfile(file):
        raise UnusableError("is damaged or is no .npz file; write it again.")
    packed = file.seek(0, 2)
    file.seek(0)
    with np.lib.npyio.NpzFile(file, allow_pickle=False) as archive:
        arrays = Archive(archive)
        if arrays.unpacked > max(HARMLESS, MOST_TIMES * packed):
            raise UnusableError(
                f"has {packed / 1e6:,.1f} MB, and would unpack to {arrays.unpacked / 1e6:,.0f} MB, "
                f"more than {MOST_TIMES} times as much; if you trust it, write it again "
                "without compression."
            )
        yield arrays
