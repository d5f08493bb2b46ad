"""The exceptions and the warning of gaussmap: every error is a `GaussmapError`."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar
from unicodedata import category

__all__ = [
    "FileError",
    "GaussmapError",
    "GaussmapWarning",
    "InputError",
    "MissingExtraError",
    "MissingFieldError",
    "SurfaceError",
    "UnknownNameError",
]


def __dir__() -> list[str]:
    return __all__


class GaussmapError(Exception):
    """Base class of all errors that gaussmap raises on purpose.

    Examples
    --------
    >>> import gaussmap as gm
    >>> try:
    ...     gm.sample("donut", 1000)
    ... except gm.GaussmapError as error:
    ...     print(type(error).__name__)
    UnknownNameError

    """

    def __init__(self, message: str = "") -> None:
        super().__init__(_cut(printable(message)))


class InputError(GaussmapError, ValueError):
    """An argument has the wrong shape, type, sign or range, or holds NaN or infinity.

    It is a ValueError, too.

    Examples
    --------
    >>> import gaussmap as gm
    >>> try:
    ...     gm.directions.icosphere(-1)
    ... except gm.errors.InputError as error:
    ...     print(isinstance(error, ValueError))
    True

    """


class SurfaceError(GaussmapError):
    """A surface, curve or part cannot be evaluated or sampled; its callable raised, for example.

    Examples
    --------
    >>> import gaussmap as gm
    >>> flat = gm.Surface.from_callable(lambda u, v: u, ((0, 1), (0, 1)))  # no points
    >>> try:
    ...     gm.fit(flat)
    ... except gm.errors.SurfaceError as error:
    ...     print("surface" in str(error))
    True

    """


class UnknownNameError(GaussmapError, LookupError):
    """A name, such as that of a surface, a formula or a field, does not exist.

    It is a LookupError, too; the message lists similar names, or all names.

    Examples
    --------
    >>> import gaussmap as gm
    >>> try:
    ...     gm.fit("tors")
    ... except gm.errors.UnknownNameError as error:
    ...     print("torus" in str(error))
    True

    """


class FileError(GaussmapError, OSError):
    """A file cannot be read or written, or is not of the format that its name says.

    It is an OSError, too.

    Examples
    --------
    >>> import gaussmap as gm
    >>> try:
    ...     gm.read_samples("missing.ply")
    ... except gm.errors.FileError as error:
    ...     print(isinstance(error, OSError))
    True

    """


class MissingExtraError(GaussmapError, ImportError):
    """An optional dependency is not installed; the message names the extra that installs it.

    It is an ImportError, too.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 50, cells=(16, 16))
    >>> try:
    ...     table = samples.to_dataframe()
    ... except gm.errors.MissingExtraError:
    ...     table = samples.arrays()  # without pandas
    >>> len(table["support"])
    50

    """


class MissingFieldError(GaussmapError, AttributeError):
    """Samples lack a field that was not requested when they were made (see `fields` of `sample`).

    It is an AttributeError, too, so that `hasattr(samples, name)` is False.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 50, cells=(16, 16), fields=("points",))
    >>> hasattr(samples, "points"), hasattr(samples, "support")
    (True, False)

    """


class GaussmapWarning(UserWarning):
    """A result is valid but falls short of the request; the message gives the reason.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     samples = gm.sample("cylinder", normals=[[0, 0, 1]])
    >>> len(samples), [x.category.__name__ for x in caught]
    (0, ['GaussmapWarning'])

    """

    def __init__(self, message: str = "") -> None:
        super().__init__(printable(message))


LONGEST_SHOWN = 60
# Unicode categories of characters that are escaped: control characters, characters that change the
# format or the direction of writing, surrogates, separators of lines and of paragraphs.
CONTROLS = ("Cc", "Cf", "Cs", "Zl", "Zp")
LONGEST_MESSAGE = 300


def _cut(message: str) -> str:
    """Return a message; the middle of a long one (with a long path, say) is left out."""
    if len(message) <= LONGEST_MESSAGE:
        return message
    half = LONGEST_MESSAGE // 2
    return f"{message[: half - 1]}…{message[-half:]}"


def printable(text: str) -> str:
    """Return a text on one line, with escapes for control characters and lone surrogates."""
    if text.isprintable():
        return text
    return "".join(
        x.encode("unicode_escape").decode() if category(x) in CONTROLS else x for x in text
    )


def shown(value: object) -> str:
    """Return the text of a value for a message: one short line. Raises nothing."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # long integers, and exceptions of users' objects
        text = f"something of type {type(value).__name__}"
    return clipped(text)


def clipped(text: str) -> str:
    """Return a text for a message, cut at its end if it is long."""
    text = printable(text)
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"


P = ParamSpec("P")
R = TypeVar("R")


def in_memory(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function raise InputError in place of MemoryError."""

    @wraps(function)
    def guarded(*arguments: P.args, **named: P.kwargs) -> R:
        try:
            return function(*arguments, **named)
        except MemoryError:
            raise InputError(
                "there is not enough memory for this; if normals, samples or cells are many, use "
                "fewer."
            ) from None

    return guarded
