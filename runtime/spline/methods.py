"""What `Spline` has from modules that import it: `methods.pyi` says what it is."""

from __future__ import annotations

from ..base.later import Later

__all__ = ["Methods"]


class Methods:
    """Splines made in other ways than by `fit`."""

    from_nets = Later("gaussmap.runtime.spline.nets")
