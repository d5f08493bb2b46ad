"""What `Spline` and `NetSpline` have from modules above: `methods.pyi` says what it is."""

from __future__ import annotations

from ..base.later import Later

__all__ = ["Methods", "NetMethods"]


class Methods:
    """Splines made in other ways than by `fit`."""

    from_nets = Later("gaussmap.runtime.spline.nets")


class NetMethods:
    """What is made of splines of nets."""

    mesh = Later("gaussmap.tools.meshes.of_nets")
