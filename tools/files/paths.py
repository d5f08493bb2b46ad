"""Writing files so that a file at its path is either complete or absent.

Everything is written to a temporary file in the same folder, which then replaces the target in one
step.
"""

import errno
import os
import secrets
import stat
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ...runtime.base.errors import FileError, GaussmapError, InputError, UnknownNameError, shown

PathLike = str | os.PathLike[str]

# The largest number of characters that are quoted from a library's own message.
MOST_SAID = 100
# The prefix of the names of temporary files.
BEGUN = ".gaussmap-"


def known_suffix(path: PathLike, known: Sequence[str]) -> str:
    """Return the suffix of a path in lower case; UnknownNameError if it is not in `known`."""
    path = checked_path(path)
    suffix = path.suffix.lower()
    if suffix not in known:
        what = f"the suffix '{path.suffix}'" if suffix else "no suffix"
        raise UnknownNameError(f"'{path}' has {what}; use one of {', '.join(known)}.")
    return suffix


def check_target(path: PathLike, suffixes: Sequence[str]) -> None:
    """Raise the errors that writing to `path` would raise; to be called before long work.

    The suffix must be one of `suffixes`, which are in lower case with their dots. To test that the
    folder is writable, an empty file is created in it and removed.

    Raises UnknownNameError if the suffix is none of `suffixes`, and FileError if the folder is
    missing or read-only or `path` is a folder or protected.
    """
    path = checked_path(path)
    known_suffix(path, suffixes)
    probe = _temporary(_target(path))
    try:
        probe.touch(exist_ok=False)
    except OSError as error:
        raise _not_written(path, error) from error
    finally:
        with suppress(OSError):
            probe.unlink()


@contextmanager
def atomic_path(path: PathLike) -> Iterator[Path]:
    """Yield a temporary path to write to; the file replaces `path` when the block succeeds.

    The temporary file lies in the same folder and has the same suffix. If the block raises,
    KeyboardInterrupt included, the temporary file is removed and an existing file at `path` stays
    as it was. A new file gets the permissions of the umask; a replacement keeps those of the
    replaced file. A symbolic link is followed, not replaced.

    Raises FileError if the folder is missing, if `path` is a folder, protected or not a regular
    file, or if the block raises an OSError, for example because the disk is full.
    """
    path = checked_path(path)
    target = _target(path)
    temporary = _temporary(target)
    try:
        yield temporary
        # Errors are ignored, as there may be no older file, or no permissions on the file system.
        with suppress(OSError):
            temporary.chmod(stat.S_IMODE(target.stat().st_mode))
        os.replace(temporary, target)
    except GaussmapError:
        raise
    except OSError as error:
        raise _not_written(path, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink()


@contextmanager
def written_by_library(path: PathLike) -> Iterator[None]:
    """Turn any exception of a library that writes a file into a FileError.

    Libraries for compressed files raise exceptions of their own types if the disk is full.
    """
    try:
        yield
    except (GaussmapError, MemoryError, OSError):
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:MOST_SAID].rstrip(".")
        raise FileError(
            f"'{path}' cannot be written ({reason}); make room, or choose another disk or format."
        ) from error


def checked_path(path: PathLike) -> Path:
    """Return the argument as a Path; InputError if it is not a valid path."""
    try:
        result = Path(path)
    except TypeError:
        raise InputError(f"a path must be a string or a Path, not {shown(path)}.") from None
    try:
        os.fsencode(result)
    except UnicodeEncodeError:
        raise InputError(
            f"a path cannot hold lone surrogates, as {shown(str(result))} does."
        ) from None
    if not os.fspath(path):
        raise InputError("the name of the file is empty.")
    if "\0" in str(result):
        raise InputError(f"a path cannot hold a null character, as {str(result)!r} does.")
    return result


def _target(path: Path) -> Path:
    """Return the path with symbolic links resolved; FileError if no file can be written there."""
    target = Path(os.path.realpath(path))
    try:
        folder, mode = _mode(target.parent), _mode(target)
    except OSError as error:
        raise _not_written(path, error) from error
    if folder is None or not stat.S_ISDIR(folder):
        problem = "does not exist" if folder is None else "is not a folder"
        raise FileError(
            f"'{path}' cannot be written: '{target.parent}' {problem}; "
            "create the folder first or choose another."
        )
    if mode is None:
        return target
    if stat.S_ISDIR(mode):
        raise FileError(f"'{path}' is a folder; give the name of a file in it.")
    if not stat.S_ISREG(mode):
        raise FileError(f"'{path}' is a device or a pipe; give the name of a file.")
    if not os.access(target, os.W_OK):
        raise FileError(f"'{path}' is write-protected; unprotect it or choose another name.")
    return target


def _mode(path: Path) -> int | None:
    """Return the mode of the file at `path`, its type and permissions; None if there is no file."""
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None


def _temporary(target: Path) -> Path:
    # Not tempfile, whose files are private to the user (mode 0600) whatever the umask. The name
    # does not contain the stem of the target, since it could become too long.
    return target.with_name(f"{BEGUN}{secrets.token_hex(8)}{target.suffix}")


def reason_of(error: OSError) -> str:
    """Return the message of the operating system for an error."""
    return error.strerror or str(error) or type(error).__name__


def _not_written(path: Path, error: OSError) -> FileError:
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        hint = "make room or choose another disk"
    elif error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        hint = "choose a folder that you may write to"
    else:
        hint = "choose another place"
    return FileError(f"'{path}' cannot be written: {reason_of(error)}; {hint}.")
