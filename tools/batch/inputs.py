"""The parts of a data set: surfaces, and files that a worker reads."""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...runtime.base.errors import FileError, InputError, shown
from ...runtime.base.extras import from_extra
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import CATALOGUE, CatalogueFunction, named
from ..cad.part import Part
from ..files.numpy_files import array_file
from ..files.paths import checked_path, reason_of
from ..files.reading import UnusableError, regular_file
from .manifest import as_text

Source = Surface | Spline | Part | str | os.PathLike[str]
# The fingerprint of a surface is its points at this number of parameters along u and along v:
# enough to detect small changes, and fewer points than sampling evaluates.
LATTICE = 17


@dataclass(frozen=True, slots=True)
class Input:
    """A part: its index in the list, its name, its source, and the data sent to a worker.

    The data are a path, or FILE.npz:NAME, or a pickled surface, which only the worker unpickles.
    """

    part: int
    name: str
    source: str
    path: str | None = None
    pickled: bytes = b""


def inputs_of(sources: Iterable[Source]) -> Iterator[Input]:
    """Yield the `Input` of each entry of a list of parts.

    Whether files exist is not checked: a worker does that. Raises InputError for an entry that is
    neither a surface nor a name or path.
    """
    for part, source in enumerate(sources):
        if isinstance(source, str) and source in CATALOGUE:
            yield _of_surface(part, named(source))
        elif isinstance(source, str | os.PathLike):
            path = checked_path(source)
            file = array_file(str(path))
            name = file.stem + str(path)[len(str(file)) :]  # with the name of an array in the file
            yield Input(part, as_text(name), as_text(str(path)), os.path.abspath(path))
        elif isinstance(source, Surface | Spline | Part):
            yield _of_surface(part, source)
        else:
            raise InputError(
                f"part {part} must be a Surface, Spline or Part, the name of a surface, or a path, "
                f"not {shown(source)}."
            )


def _of_surface(part: int, surface: Surface | Spline | Part) -> Input:
    # Functions defined in the user's program or notebook must be pickled by value to be unpickled
    # elsewhere.
    pickle = from_extra("cloudpickle", "batch", "a data set of surfaces")
    try:
        name = as_text(str(surface.name or "surface"))
        return Input(part, name, type(surface).__name__, None, pickle.dumps(surface))
    except Exception as error:  # of any type, since users' functions may contain anything
        raise InputError(
            f"part {part} ({surface.name}) cannot be sent to another process: its function cannot "
            f"be pickled ({type(error).__name__}: {error})."
        ) from error


# --- in the worker --------------------------------------------------------------------------------


def content_of(source: Surface | Spline | Part | Path) -> str:
    """Return a SHA-256 that identifies a part, from the bytes of its file, arrays or points.

    A surface given by a function is identified by its points at a lattice of parameters; the code
    of the function does not matter.
    """
    digest = hashlib.sha256(type(source).__name__.encode())
    if isinstance(source, Path):
        _add_file(digest, source)
    elif isinstance(source, Part):
        for name in sorted(source.arrays):
            _add_array(digest, source.arrays[name])
        for held in source.surfaces.values():
            _add_surface(digest, held)
    elif isinstance(source, Spline):
        _add_array(digest, source.coefficients)
        digest.update(repr((source.domain, source.boundary)).encode())
    else:
        _add_surface(digest, source)
    return digest.hexdigest()


def parameters_of(source: Surface | Spline | Part) -> str:
    """Return the parameters of a catalogue surface as JSON; for other parts, an empty text."""
    function = getattr(source, "function", None)
    if not isinstance(function, CatalogueFunction):
        return ""
    return json.dumps(
        dict(zip(CATALOGUE[function.name]["parameters"], function.values, strict=True))
    )


def _add_surface(digest: Any, surface: Surface) -> None:  # noqa: ANN401
    digest.update(repr((surface.domain, surface.boundary, surface.assumed_open)).encode())
    if surface.grid is not None:
        _add_array(digest, surface.grid)
        return
    u, v = np.meshgrid(*(np.linspace(low, high, LATTICE) for low, high in surface.domain))
    _add_array(digest, surface.evaluate(u, v))
    if surface.trim is not None:
        _add_array(digest, surface.trim.contains(np.stack([u.ravel(), v.ravel()], axis=-1), 1))
        for condition in surface.trim.parts:
            for polygon in getattr(condition, "polygons", ()):
                _add_array(digest, polygon)


def _add_array(digest: Any, array: Any) -> None:  # noqa: ANN401
    array = np.ascontiguousarray(array)
    digest.update(f"{array.dtype.str}{array.shape}".encode())
    digest.update(array.data)


def _add_file(digest: Any, path: Path) -> None:  # noqa: ANN401
    try:
        with regular_file(path) as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    except UnusableError as error:
        raise FileError(f"'{path}' {error}") from error
    except FileNotFoundError:
        raise FileError(f"'{path}' does not exist.") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {reason_of(error)}.") from error
