"""Meshes of convolutions of convex bodies: the convex hull of the sums."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.errors import InputError
from ...runtime.base.memory import check_memory
from ...runtime.base.progress import busy
from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import Boundary
from .links import neighbours
from .mesh import scaled
from .meshing import checked_angle, finished
from .triangulated import Prefer, Triangulated, checked_prefer, too_few
from .triangulation import convex_hull

if TYPE_CHECKING:
    from ..support.convolution import Convolution
    from .mesh import Mesh

# Longitudes and latitudes of normals.
DOMAIN = (-np.pi, np.pi), (-np.pi / 2.0, np.pi / 2.0)
BOUNDARY: Boundary = ("periodic", "periodic"), ("pole", "pole")
# A sum may be this far outside of the tangent plane of another sum, relative to the size of the
# body: normals and points carry rounding errors, and the patches of a spline meet up to rounding
# errors.
OUTSIDE = 1e-9


def mesh(
    self: Convolution,
    *,
    angle: float | None = None,
    prefer: Prefer = "shape",
    progress: bool = False,
) -> Mesh:
    """Return the boundary of the Minkowski sum of two convex bodies as a triangle mesh.

    It is the convex hull of the sums, with edges flipped. Each sum has to be on the hull, and the
    hull on one side of its tangent plane: surfaces that fold, such as a torus, have no mesh. The
    hull of selected sums closes all gaps between them. Sums that are farthest along their normals,
    for example, lie on the boundary of the Minkowski sum of the convex hulls of the two surfaces.

    Parameters
    ----------
    angle : float, optional
        The largest deviation of triangles from normals, in degrees, as in `Samples.mesh`. Give it
        if the normals do not cover the sphere.
    prefer : {"shape", "normals"}, default "shape"
        As in `Samples.mesh`; for "normals", the mesh is convex.
    progress : bool, default False
        Show the progress on a terminal, after the first second.

    Returns
    -------
    Mesh
        The vertices are sums; `uv` are the longitudes and latitudes of their normals, in radians.
        Triangles run counterclockwise around the normals, which point outwards if those of the
        bodies do.

    Raises
    ------
    InputError
        If the sums do not bound a convex body, and, without `angle`, if normals leave too large
        gaps.

    Examples
    --------
    >>> import gaussmap as gm
    >>> ball = gm.SupportFunction.from_sympy("1/10")
    >>> sums = gm.convolve(gm.surfaces.ellipsoid(3, 2, 1), ball, gm.icosphere(8))
    >>> sums.mesh(prefer="normals")
    Mesh(642 vertices, 1,280 triangles on ellipsoid + SupportFunction(h = 1/10))

    """
    preferred, largest = checked_prefer(prefer), checked_angle(angle)
    check_memory("mesh", len(self))
    with busy("meshing", progress):
        hull = _hull(self)
        if angle is None and not (hull.cosines() > 0.0).all():
            raise too_few(len(self), hull.name)
        return finished(hull, len(self), preferred, largest)


def _hull(sums: Convolution) -> Triangulated:
    """Return the convex hull of sums; InputError unless all their tangent planes support it."""
    from scipy.spatial import QhullError

    points, normals, name = sums.points, sums.normals, sums.report.surface
    triangles = np.empty((0, 3), dtype=np.int64)
    if len(points) and np.isfinite(points).all():
        with suppress(QhullError):
            triangles = convex_hull(scaled(points))
    if not len(triangles):
        raise InputError(f"these sums on {name!r}, {len(sums):,} in all, do not bound a body.")
    side = np.sign(np.einsum("nx,nx", points - points.mean(axis=0), normals)) or 1.0
    supported = _supported(scaled(points), side * normals, triangles)
    if not supported.all():
        count = int(np.count_nonzero(~supported))
        raise InputError(
            f"these sums on {name!r} are not on a convex body, and have no mesh: there are sums on "
            f"both sides of the tangent planes of {count:,} of {len(sums):,}."
        )
    if side < 0.0:
        triangles = np.take(triangles, [0, 2, 1], axis=1)  # in C order, as kernels take it
    uv = np.stack([np.arctan2(normals[:, 1], normals[:, 0]), np.arcsin(normals[:, 2])], axis=1)
    adjacent, _ = neighbours(triangles, np.zeros(len(sums), dtype=np.bool_))
    every, free = np.arange(len(sums)), np.ones(len(sums), dtype=np.bool_)
    return Triangulated(
        name, uv, every, free, points, normals, triangles, np.ones_like(triangles), adjacent,
        ~free, DOMAIN, BOUNDARY,
    )  # fmt: skip


def _supported(points: Array, outwards: Array, triangles: Indices) -> Flags:
    """Return whether points (n,) are on a hull and their tangent planes support it.

    Tangent planes are compared with neighbouring vertices only: if all neighbours of a vertex are
    on one side of a plane through it, so is the whole hull.
    """
    tolerance = OUTSIDE * float(np.linalg.norm(np.ptp(points, axis=0)))
    vertices = np.unique(triangles)
    found = tree_of(points[vertices]).query(points)[0] <= tolerance
    for turn in (1, 2):
        to_next = points[np.roll(triangles, turn, axis=1)] - points[triangles]
        heights = np.einsum("kcx,kcx->kc", to_next, outwards[triangles])
        found[triangles[heights > tolerance]] = False
    return found
