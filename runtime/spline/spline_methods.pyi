"""Methods of `Spline` and `NetSpline` that later modules define; `spline_methods.py` loads them."""

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

class NetMethods:
    from ...tools.meshes.of_nets import mesh as mesh
