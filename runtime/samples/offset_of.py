"""The origin of the samples of an offset."""

from dataclasses import dataclass

from ..spline.nets import AnySpline
from ..surface.surface import Surface
from .whole import Whole


@dataclass(frozen=True)
class OffsetOf:
    """The surface from which the samples of an offset were moved, and the distance.

    Meshes of the samples need both.

    Attributes
    ----------
    distance : float
        The distance by which the samples were moved along the normals, in L.
    spline : Spline or None
        The spline that was sampled, None if it is unknown.
    surface : Surface, Part or None
        The surface, or the CAD part, on which the samples were before they were moved.
    trimmed : bool
        Whether a trimmed offset has left out samples.

    Examples
    --------
    >>> import gaussmap as gm
    >>> moved = gm.sample("torus", 200, cells=(16, 16)).offset(0.1).offset(0.1)
    >>> moved.offset_of.distance, moved.offset_of.spline, moved.spline, moved.surface
    (0.2, Spline(16 × 16 cells of torus), None, None)

    """

    distance: float
    spline: AnySpline | None = None
    surface: Surface | Whole | None = None
    trimmed: bool = False
