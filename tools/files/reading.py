"""Opening files for reading, with one sentence for each kind of error."""

import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

from ...runtime.base.errors import FileError, InputError
from .paths import reason_of

# The beginning of a pointer file, which Git LFS leaves in place of a large file; the error for it.
LFS = b"version https://git-lfs.github.com/spec/"
POINTER = "is a Git LFS pointer, not the file itself; get that with 'git lfs pull'."


class UnusableError(Exception):
    """An error for a file with invalid content.

    Its text continues a sentence that begins with the path of the file.
    """


def regular_file(path: Path | str) -> BufferedReader:
    """Open a file for reading. Raises UnusableError for devices, pipes and Git LFS pointers.

    Opening a pipe into which nobody writes would block forever.
    """
    path = Path(path)
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise UnusableError("is a device or a pipe; give the name of a file.")
    file = open(path, "rb")  # noqa: SIM115 - returned open
    if file.peek(len(LFS)).startswith(LFS):
        file.close()
        raise UnusableError(POINTER)
    return file


@contextmanager
def opened(path: Path, kind: str, content: str) -> Iterator[BufferedReader]:
    """Yield an open file; any error while reading it becomes a FileError that names the path.

    Error messages contain both words: `kind`, which follows "is no", and `content`, which names the
    content of the file.
    """
    try:
        file = regular_file(path)  # tells an error here from one in the content
    except UnusableError as error:
        raise FileError(f"'{path}' {error}") from error
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {reason_of(error)}.") from error
    with file, readable(path, kind, content):
        yield file


@contextmanager
def readable(path: Path | str, kind: str, content: str) -> Iterator[None]:
    """Turn any error while reading into a FileError; see `opened`."""
    try:
        yield
    except UnusableError as error:
        raise FileError(f"'{path}' {error}") from error
    except InputError as error:
        raise FileError(f"'{path}' holds unusable {content}: {error}") from error
    except Exception as error:  # NumPy, zipfile and json raise a dozen types on bad bytes
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise FileError(
            f"'{path}' is damaged or is no {kind} ({reason}); write it again."
        ) from error
