"""Arrays in files, named FILE.npy, FILE.npz or FILE.npz:NAME. Nothing is unpickled."""

import re
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.checks import known_name
from ...runtime.base.errors import FileError, GaussmapError, InputError
from .archives import archive_of
from .reading import UnusableError, regular_file


def is_array_file(source: str) -> bool:
    """Return whether a text names an array in a file; the file need not exist."""
    return array_file(source).suffix.lower() in (".npy", ".npz")


def array_file(source: str) -> Path:
    """Return the path of the file in FILE.npy, FILE.npz or FILE.npz:NAME, without NAME."""
    return Path(_parts(source)[0])


def _parts(source: str) -> tuple[str, str | None]:
    match = re.fullmatch(r"(.+\.np[yz]):([^/\\]+)", source, re.IGNORECASE | re.DOTALL)
    return (match[1], match[2]) if match else (source, None)


def read_array(source: str) -> NDArray[Any]:
    """Return the array named FILE.npy, FILE.npz or FILE.npz:NAME; nothing is unpickled."""
    file_name, key = _parts(source)
    try:
        if not is_array_file(file_name):
            raise InputError(f"'{file_name}' is neither a .npy nor a .npz file; save it as one.")
        with regular_file(file_name) as file:
            return _unpacked(file, source, key)
    except (GaussmapError, MemoryError):
        raise
    except UnusableError as error:
        raise FileError(f"'{file_name}' {error}") from error
    except OSError as error:
        raise FileError(f"'{file_name}' cannot be read: {error.strerror or error}.") from error
    except Exception as error:  # NumPy and zipfile raise a dozen types of exceptions on bad bytes
        raise FileError(
            f"'{file_name}' is damaged, or holds objects instead of numbers "
            f"({type(error).__name__}: {error}); write it again, with NumPy."
        ) from error


def _unpacked(file: BufferedReader, source: str, key: str | None) -> NDArray[Any]:
    if Path(file.name).suffix.lower() == ".npy":
        if key is not None:
            raise InputError(f"'{file.name}' holds one array, without a name; leave out ':{key}'.")
        return np.lib.format.read_array(file, allow_pickle=False)
    with archive_of(file) as archive:
        keys = archive.names
        if key is None and len(keys) != 1:
            raise InputError(
                f"'{source}' holds {len(keys)} arrays{': ' if keys else ''}{', '.join(keys)}; "
                f"name the one to read, as in {source}:{keys[0] if keys else 'NAME'}."
            )
        name = keys[0] if key is None else known_name(key, keys, f"array in '{file.name}'")
        return archive.read(name)
