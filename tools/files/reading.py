"""Opening files for reading, with one sentence for each kind of error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

from ...runtime.base.errors import FileError, InputError
from .paths import reason_of

__all__ = ["UnusableError", "opened", "readable"]


class UnusableError(Exception):
    """The content of a file is invalid; the text continues "'path' …"."""


@contextmanager
def opened(path: Path, kind: str, content: str) -> Iterator[BufferedReader]:
    """Yield an open file; any error while reading it becomes a FileError that names the path.

    `kind` continues "is no", and `content` says what the file holds, for the sentences.
    """
    try:
        file = open(path, "rb")  # noqa: SIM115 - an error here differs from one in the content
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
