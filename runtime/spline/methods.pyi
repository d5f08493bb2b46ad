"""What `Spline` has from modules that import it; `methods.py` loads it."""

from numpy.typing import ArrayLike

from .nets import NetSpline

class Methods:
    @staticmethod
    def from_nets(
        nets: ArrayLike,
        triangles: ArrayLike | None = None,
        *,
        name: str = "nets",
        smooth: float = 0.01,
    ) -> NetSpline: ...
