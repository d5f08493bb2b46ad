"""The interface of objects that consist of several surfaces, such as CAD parts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

if TYPE_CHECKING:
    from ..directions.regions import Reach


class FaceColumn(NamedTuple):
    """A column of tables with a property of faces: its type, and a value for each face.

    A value may be None. `unit` is "L" for lengths, otherwise "".
    """

    name: str
    dtype: type[int] | type[float] | type[str]
    values: Sequence[float | str | None]
    unit: str = ""


class NormalDeviation(NamedTuple):
    """The largest angles between normals of a surface and those of its samples, in degrees.

    Attributes
    ----------
    normal_space : float
        Between the normal of a point and the nearest normal of any sample.
    space : float
        Between the normal of a point and that of the sample nearest in space.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", angle=20.0, cells=(16, 16))
    >>> deviation = samples.normal_deviation()
    >>> deviation.normal_space <= 20.0, deviation.space >= deviation.normal_space
    (True, True)

    """

    normal_space: float
    space: float


class Whole:
    """A whole of several surfaces: the base class of CAD parts, which define these methods."""

    @property
    def unit(self) -> str:
        """The unit L of all lengths, as "mm" or "in"; empty if it is not known."""
        raise NotImplementedError

    def _sampled(self, *given: object) -> tuple[Any, NDArray[np.float64]]:
        """Return the result of `sample`, and the unit normals that were searched."""
        raise NotImplementedError

    def _samples_at(
        self, normals: NDArray[np.float64], fields: Sequence[str], dtype: DTypeLike,
        threads: int | None, progress: bool,
    ) -> Any:  # noqa: ANN401  # fmt: skip
        """Return all points that have one of the unit normals (S, 3)."""
        raise NotImplementedError

    def _space(self, threads: int | None, *, reach: Reach | None = None) -> Any:  # noqa: ANN401
        """Return the `Space` of the whole, or of its points in a `reach`."""
        raise NotImplementedError

    def _face_columns(self) -> list[FaceColumn]:
        """Return the columns with properties of faces, for tables of samples."""
        raise NotImplementedError

    def _boundaries(self) -> Any:  # noqa: ANN401
        """Return the boundaries of all surfaces, as a list of `Segments`."""
        raise NotImplementedError
