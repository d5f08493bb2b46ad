"""What gaussmap raises and warns: every error is a `GaussmapError` with a message for users."""

from __future__ import annotations

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
