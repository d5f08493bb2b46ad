"""The Gauss map: images of patches, and parabolic points, where it folds."""

from .boundary import BoundaryArc
from .classes import PatchClass, classify_patches
from .image import GaussianImage, GaussianImages
from .image_curve import ImageCurve
from .parabolic import ParabolicPoint, ParabolicPoints, parabolic_points
from .parabolic_lines import ParabolicLine, Piece, parabolic_lines, split_patch

__all__ = [
    "BoundaryArc",
    "GaussianImage",
    "GaussianImages",
    "ImageCurve",
    "ParabolicLine",
    "ParabolicPoint",
    "ParabolicPoints",
    "PatchClass",
    "Piece",
    "classify_patches",
    "parabolic_lines",
    "parabolic_points",
    "split_patch",
]


def __dir__() -> list[str]:
    return __all__
