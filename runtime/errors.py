"""What gaussmap raises and warns: every error is a `GaussmapError` with a message for users."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

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


class GaussmapError(Exception):
    """Base class of every error that gaussmap raises on purpose."""


class InputError(GaussmapError, ValueError):
    """An argument has the wrong shape, type, sign or range, or holds NaN or infinity."""


class SurfaceError(GaussmapError):
    """A surface or a curve cannot be evaluated: its callable raised, or returned no points."""


class UnknownNameError(GaussmapError, LookupError):
    """A surface, formula or file type of that name does not exist."""


class FileError(GaussmapError, OSError):
    """A file cannot be read or written, or is not what its name says."""


class MissingExtraError(GaussmapError, ImportError):
    """An optional dependency is not installed; the message names the extra that brings it."""


class MissingFieldError(GaussmapError, AttributeError):
    """Samples lack a field that was not asked for when they were made (see `fields` of `sample`).

    As an AttributeError it makes `hasattr(samples, name)` false.
    """


class GaussmapWarning(UserWarning):
    """A result is valid but less than what was asked for; the message says why."""


LONGEST_SHOWN = 60


def shown(value: object) -> str:
    """Return a value as a message shows it: on one line, not too long, and never an error."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # whole numbers of many digits, and what objects of users raise
        text = f"something of type {type(value).__name__}"
    text = text.encode("utf-8", "backslashreplace").decode()
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"


P = ParamSpec("P")
R = TypeVar("R")


def in_memory(function: Callable[P, R]) -> Callable[P, R]:
    """Have a function raise InputError where there is too little memory for what it is asked."""

    @wraps(function)
    def guarded(*arguments: P.args, **named: P.kwargs) -> R:
        try:
            return function(*arguments, **named)
        except MemoryError:
            raise InputError(
                "there is not enough memory for this; ask for fewer normals, samples or cells."
            ) from None

    return guarded
