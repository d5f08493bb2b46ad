"""Classes of quadratic patches by the sign of their Gaussian curvature (paper, Remark 3.1)."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.spline.nets import AnySpline
from .parabolic_lines import cubic_bernstein, pieces_of
from .patches import Patches, checked_nets

# The cubic whose sign is that of K is sampled on a lattice of this size inside the triangle. If it
# has both signs there, the patch is MIXED, and its parabolic lines need not be computed.
LATTICE = 8
INSIDE = cubic_bernstein(
    np.array([(i, j) for i in range(1, LATTICE) for j in range(1, LATTICE - i)]) / LATTICE
)


class PatchClass(IntEnum):
    """The class of a patch by the sign of its Gaussian curvature K, see `classify_patches`.

    Attributes
    ----------
    PLANAR
        The normal is constant.
    DEVELOPABLE
        K = 0 everywhere.
    ELLIPTIC
        K > 0 inside.
    HYPERBOLIC
        K < 0 inside.
    MIXED
        A parabolic line separates elliptic from hyperbolic parts (paper, Remark 3.1).
    SINGULAR
        No point has a normal.

    Examples
    --------
    >>> import gaussmap as gm
    >>> Class = gm.gauss_map.PatchClass
    >>> classes = gm.gauss_map.classify_patches(gm.fit("torus", (16, 16))).tolist()
    >>> sorted(set(classes)) == [Class.ELLIPTIC, Class.HYPERBOLIC]
    True
    >>> others = Class.PLANAR, Class.DEVELOPABLE, Class.MIXED, Class.SINGULAR
    >>> any(x in classes for x in others)
    False

    """

    PLANAR = 0
    DEVELOPABLE = 1
    ELLIPTIC = 2
    HYPERBOLIC = 3
    MIXED = 4
    SINGULAR = 5


def classify_patches(patches: AnySpline | ArrayLike) -> NDArray[np.int8]:
    """Return the classes of quadratic patches by the sign of their Gaussian curvature.

    Parameters
    ----------
    patches : Spline or (k, 6, 3) array_like
        The patches of a spline, or Bézier nets in the order b200, b020, b002, b110, b101, b011.

    Returns
    -------
    (k,) int8 array
        A `PatchClass` for each patch. PLANAR: the normal is constant. DEVELOPABLE: the Gaussian
        curvature vanishes everywhere. ELLIPTIC, HYPERBOLIC: it has one sign inside. MIXED: a
        parabolic line separates elliptic from hyperbolic parts (paper, Remark 3.1). SINGULAR: no
        point has a normal.

    Raises
    ------
    InputError
        For nets of another shape, NaN, infinity, or numbers too large.

    Notes
    -----
    If the ten Bézier coefficients of the cubic `parabolic_cubic` have the same sign, this sign
    decides; otherwise, values of the cubic or the parabolic lines decide. Numbers that are zero up
    to the rounding of the coordinates count as zero.

    Examples
    --------
    >>> import gaussmap as gm
    >>> classes = gm.gauss_map.classify_patches(gm.fit("sphere", (8, 8)))
    >>> gm.gauss_map.PatchClass.ELLIPTIC in classes.tolist()
    True

    """
    if isinstance(patches, AnySpline):
        return classes_of(Patches.of_spline(patches))
    return classes_of(Patches.of_control_points(checked_nets(patches)))


def classes_of(patches: Patches) -> NDArray[np.int8]:
    """Return the class of each patch (k,)."""
    error = patches.cubic_rounding[:, None]
    positive = (patches.cubic > error).any(axis=1)
    negative = (patches.cubic < -error).any(axis=1)
    result = np.where(positive, PatchClass.ELLIPTIC, PatchClass.HYPERBOLIC).astype(np.int8)
    result[patches.flat] = PatchClass.DEVELOPABLE
    net = patches.normals.reshape(len(patches), 9, 3)
    lengths = np.linalg.norm(net, axis=2)
    longest = np.take_along_axis(net, lengths.argmax(axis=1)[:, None, None], axis=1)
    across = np.linalg.norm(np.cross(net, longest), axis=2).max(axis=1)
    result[across <= 4.0 * patches.normal_noise * lengths.max(axis=1)] = PatchClass.PLANAR
    result[lengths.max(axis=1) == 0.0] = PatchClass.SINGULAR
    curved = positive & negative & (result >= PatchClass.ELLIPTIC) & (result != PatchClass.SINGULAR)
    inside = patches.cubic @ INSIDE.T
    mixed = curved & (inside > error).any(axis=1) & (inside < -error).any(axis=1)
    result[mixed] = PatchClass.MIXED
    for k in np.flatnonzero(curved & ~mixed):
        signs = {piece.sign for piece in pieces_of(patches[k : k + 1])}
        alone = PatchClass.ELLIPTIC if 1 in signs else PatchClass.HYPERBOLIC
        result[k] = PatchClass.MIXED if {1, -1} <= signs else alone
    return result
