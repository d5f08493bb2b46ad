"""What samples may lie on that is more than one surface: it answers for all of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .density.deviation import NormalDeviation
    from .samples import Samples

__all__ = ["Whole"]


class Whole(ABC):
    """A CAD part, for example."""

    @abstractmethod
    def coverage_of(self, points: NDArray[np.floating], threads: int | None) -> float:
        """Return what `Samples.coverage` returns, for points (N, 3)."""

    @abstractmethod
    def deviation_of(
        self, points: NDArray[np.floating], normals: NDArray[np.floating], threads: int | None
    ) -> NormalDeviation:
        """Return what `Samples.normal_deviation` returns, for points and normals (N, 3)."""

    @abstractmethod
    def weights_of(self, samples: Samples) -> NDArray[np.float64]:
        """Return what `Samples.weights` returns."""
