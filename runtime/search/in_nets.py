"""The search for all points of a spline of nets with given normals, each found exactly once.

Of a pair of a patch and a normal, the signs of U, V, W decide (Sect. 3.2). A sign that rounding
leaves open, or the difference of the two patches of a joint, is that of the boundary cone of the
joint: one form for both patches, on integers. The cones of all edges at a corner pass through one
normal exactly, and ties are broken by an infinitesimal displacement of the normal, the same for all
patches. So the images of the patches are a decomposition without gaps or overlaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...generated import gaussian_image
from ...generated import patch as formulas
from ...generated.vectors import Vector
from ..base.aliases import Array, Flags, Indices
from ..base.formula_calls import patch, python_function, vector
from ..base.integers import Integers, integers, integers_by_row, ratio, sign
from ..base.kept import kept
from ..base.threads import over_ranges
from ..base.tolerances import ACCURATE, DATA_ERROR, FORM_ERROR
from ..samples.fields import FLOAT_NAMES
from ..spline.joints import EDGES
from ..spline.nets import NetSpline, vectors_of_nets
from .long_integers import displaced_forms, exact_forms, leading_sign

__all__ = ["Cones", "Found", "edge_signs", "fields_in_nets", "find_in_nets"]

# The number of pairs of a patch and a normal that are compared at a time.
PAIRS_AT_A_TIME = 1 << 22
# Cones are wider than the control normals by this, in cosine: more than their rounding.
COSINE_ERROR = 1e-12
# The rows of nets, turned so that the edges u = 0, v = 0, w = 0 become v = 0, from start to end.
TURNED = tuple(
    (x.end, k, x.start, x.end_beside, x.middle, x.start_beside) for k, x in enumerate(EDGES)
)
# The least cosine of a normal and that of the patch at its point, or next to it.
SAME_NORMAL = 0.999


class Found(NamedTuple):
    """The hits (k,): patches, rows of normals, and of those that were decided exactly (j,) which.

    `local` (j, 3) are u, v and the sign of K of these.
    """

    patches: Indices
    normals: Indices
    exact: Indices
    local: Array


class Cones(NamedTuple):
    """Of each patch (T,): a cone of all normals, the errors of U, V, W (T, 3), and if it is flat.

    `cosines` are those of the half-angles, −2 for cones that hold all directions.
    """

    axes: Array
    cosines: Array
    errors: Array
    flat: Flags

    @classmethod
    def of(cls, spline: NetSpline) -> Cones:
        """Return the cones of a spline."""
        control = spline.topology.normals
        lengths = np.linalg.norm(control, axis=2)
        some = (lengths > 0.0).all(axis=1)
        unit = control / np.where(lengths > 0.0, lengths, 1.0)[..., None]
        axes = unit.sum(axis=1)
        size = np.linalg.norm(axes, axis=1)
        axes /= np.where(size > 0.0, size, 1.0)[:, None]
        least = np.einsum("kcx,kx->kc", unit, axes).min(axis=1)
        angles = spline.topology.angles
        wide = np.cos(np.minimum(np.arccos(np.clip(least, -1.0, 1.0)) + angles, np.pi))
        cosines = np.where(some & (least > 0.0), wide - COSINE_ERROR, -2.0)
        largest = np.abs(spline.vectors).sum(axis=2).max(axis=1)
        rounding = FORM_ERROR * largest + DATA_ERROR * spline._largest * spline.scale
        errors = 8.0 * largest * (rounding + 2.0 * largest * angles)
        cubic = python_function(formulas.parabolic_cubic)(spline.patch())
        noise = rounding * largest**5
        flat = np.abs(np.stack(cubic)).max(axis=0) <= 64.0 * noise
        return cls(axes, cosines, np.repeat(errors[:, None], 3, axis=1), flat)


def cones_of(spline: NetSpline) -> Cones:
    """Return the cones of a spline, which are kept with it."""
    return kept(spline, Cones, lambda: Cones.of(spline))


def find_in_nets(spline: NetSpline, normals: Array, threads: int | None = None) -> Found:
    """Return all hits at unit normals (S, 3), sorted by patch and then by normal."""
    step = max(PAIRS_AT_A_TIME // spline.patches, 1)

    def work(first: int, last: int) -> Found:
        return _found(spline, normals, first, last)

    parts = list(over_ranges(work, len(normals), step, threads))
    starts = np.cumsum([0, *(len(x.patches) for x in parts[:-1])])
    patches = np.concatenate([x.patches for x in parts])
    numbers = np.concatenate([x.normals for x in parts])
    exact = np.concatenate([x.exact + start for x, start in zip(parts, starts, strict=True)])
    local = np.full((len(patches), 3), np.nan)
    local[exact] = np.concatenate([x.local for x in parts])
    order = np.lexsort((numbers, patches))
    local = local[order]
    exact = np.flatnonzero(~np.isnan(local[:, 0]))
    return Found(patches[order], numbers[order], exact, local[exact])


def _found(spline: NetSpline, normals: Array, first: int, last: int) -> Found:
    """Return the hits of the normals first, …, last − 1."""
    cones, some = cones_of(spline), normals[first:last]
    patches, rows = np.nonzero(cones.axes @ some.T >= cones.cosines[:, None])
    D, *forms = python_function(formulas.forms)(spline.patch(patches), vector(some[rows]))
    values, errors = np.stack(forms, axis=1), cones.errors[patches]
    signs = np.where(np.abs(values) > errors, np.sign(values), 0.0).astype(np.int8)
    possible = (signs.min(axis=1) >= 0) | (signs.max(axis=1) <= 0)
    patches, rows, signs, D = patches[possible], rows[possible], signs[possible], D[possible]
    errors = errors[possible, 0]
    open_ = (signs == 0).any(axis=1) | (np.abs(D) <= ACCURATE * errors)
    exact = np.flatnonzero(open_)
    local = np.zeros((len(patches), 3))
    inside = ~open_
    inside[exact], local[exact] = _decided(spline, patches[exact], some[rows[exact]], signs[exact])
    sure = np.flatnonzero(~open_)
    inside[sure] = _towards(spline, patches[sure], some[rows[sure]])
    kept_ = np.flatnonzero(inside)
    which = np.flatnonzero(open_[kept_])
    return Found(patches[kept_], rows[kept_] + first, which, local[kept_[which]])


def _towards(spline: NetSpline, patches: Indices, normals: Array) -> Flags:
    """Return whether normals, and not their opposites, are those of patches at their points."""
    patch, n = spline.patch(patches), vector(normals)
    D, U, V, _ = python_function(formulas.forms)(patch, n)
    u, v = python_function(formulas.parameters)(D, U, V)
    N = python_function(formulas.tangents)(patch, u, v)[2]
    return N.x * n.x + N.y * n.y + N.z * n.z > 0.0


def _agree(spline: NetSpline, patches: Indices, normals: Array, places: Array) -> Flags:
    """Return whether normals are those of patches at places (k, 2), or near singular ones.

    At a singular point the tangents are perpendicular to a whole circle of directions.
    """
    N, singular = spline.normals_in_patches(patches, places)
    least = np.where(singular, SAME_NORMAL, 0.0) * np.linalg.norm(N, axis=1)
    return np.einsum("kx,kx->k", N, normals) > least


def _decided(
    spline: NetSpline, patches: Indices, normals: Array, signs: NDArray[np.int8]
) -> tuple[Flags, Array]:
    """Decide pairs by the cones of edges; return which are hits, and u, v, sign of K (k, 3).

    At an edge on the border, a normal within the error is inside.
    """
    if len(patches) == 0:
        return np.empty(0, bool), np.empty((0, 3))
    topology = spline.topology
    signs = signs.copy()
    pairs, edges = np.nonzero(signs == 0)
    rows = 3 * patches[pairs] + edges
    joined = ~topology.on_border[rows]
    if joined.any():
        signs[pairs[joined], edges[joined]] = edge_signs(
            spline, rows[joined], normals[pairs[joined]]
        )
    low, high = signs.min(axis=1), signs.max(axis=1)
    inside = (low >= 0) & (high > 0) | (high <= 0) & (low < 0)
    inside &= ~((signs == 0) & ~topology.on_border.reshape(-1, 3)[patches]).any(axis=1)
    local = np.zeros((len(patches), 3))
    some = np.flatnonzero(inside)
    if len(some) == 0:
        return inside, local
    local[some, :2] = _places(spline, patches[some], normals[some])
    local[some, 2] = np.where(high[some] > 0, 1.0, -1.0)
    inside[some] = _agree(spline, patches[some], normals[some], local[some, :2])
    return inside, local


def _places(spline: NetSpline, patches: Indices, normals: Array) -> Array:
    """Return u, v (k, 2) of the nearest place in the triangle, of exact quotients."""
    nets, _ = integers(spline.control_nets[patches])
    vectors = np.asarray(vectors_of_nets(np.asarray(nets, dtype=object)), dtype=object)
    n, _ = integers_by_row(normals)
    values = exact_forms(np.moveaxis(vectors, 0, -1), n)
    bars = np.full((len(patches), 3), 1.0 / 3.0)
    some = np.asarray(values[0] != 0, dtype=bool)
    for k in range(3):
        bars[some, k] = ratio(values[k + 1, some], values[0, some])
    bars = np.maximum(bars, 0.0)
    return (bars / bars.sum(axis=1, keepdims=True))[:, :2]


def edge_signs(spline: NetSpline, rows: Indices, normals: Array) -> NDArray[np.int8]:
    """Return the signs (k,) of U, V or W, on the side of edges, at normals (k, 3).

    An edge j of patch p has the row 3 p + j. Its form is V of the patch turned so that the edge is
    v = 0, with the tangents at its ends projected onto the planes perpendicular to the normals that
    all patches share there. The form of the other patch of a joint is its negative. They are 0 on
    edges that are one point only.
    """
    topology = spline.topology
    owner, side = (x[rows] for x in topology.owner)
    patches, edge = np.divmod(owner, 3)
    nets, _ = integers(spline.control_nets[patches])
    turned = nets[np.arange(len(rows))[:, None], np.array(TURNED)[edge]]
    vectors = np.asarray(vectors_of_nets(np.asarray(turned, dtype=object)), dtype=object)
    shared, fan = topology.corners
    ends = []
    for at in (0, 1):
        corner = fan[patches, (edge + at + 1) % 3]
        normal, _ = integers(shared[corner])
        tangents = python_function(formulas.tangents)(patch(vectors), at, 0)
        ends += [_tangential(x, np.asarray(normal, dtype=object)) for x in tangents[:2]]
    a, b, d, e = python_function(gaussian_image.edge_vectors)(*ends)
    vectors = np.array([a, b, [0 * x for x in a], d, e], dtype=object)
    n, _ = integers_by_row(normals)
    n = n * leading_sign(n)
    signs = sign(exact_forms(vectors, n)[2])
    tied = signs == 0
    if tied.any():
        signs[tied] = displaced_forms(vectors[..., tied], n[:, tied])[1][1]
    return signs * side


def _tangential(x: Vector, normals: Integers) -> Vector:
    """Return the part of x perpendicular to normals (k, 3), times their squares; x for 0."""
    found = python_function(gaussian_image.tangential)(x, vector(normals))
    none = np.asarray((normals == 0).all(axis=1, keepdims=True), dtype=bool)
    return vector(np.where(none, np.stack(x, axis=1), np.stack(found, axis=1)))


def fields_in_nets(
    spline: NetSpline, normals: Array, found: Found, fields: Sequence[str], dtype: DTypeLike
) -> dict[str, NDArray[Any]]:
    """Return fields of samples at hits, see `Samples`; floats are stored as `dtype`."""
    patch, n = spline.patch(found.patches), normals[found.normals]
    D, U, V, _ = python_function(formulas.forms)(patch, vector(n))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u, v = (np.array(x) for x in python_function(formulas.parameters)(D, U, V))
        u[found.exact], v[found.exact] = found.local[:, 0], found.local[:, 1]
        uv = np.stack([u, v], axis=1)
        points = spline.points_in_patches(found.patches, uv)
        K, H = python_function(formulas.curvature_at)(patch, vector(n), u, v)
        K, H = K * spline.scale**2, H * spline.scale
    K[found.exact] = np.copysign(K[found.exact], found.local[:, 2])
    arrays = {
        "points": points, "normals": n, "uv": uv,
        "support": np.einsum("kx,kx->k", n, points),
        "gaussian_curvature": K, "mean_curvature": H,
        "normal_index": found.normals, "patch_index": found.patches,
    }  # fmt: skip
    return {
        name: np.ascontiguousarray(x, dtype=dtype if name in FLOAT_NAMES else np.int64)
        for name, x in arrays.items()
        if name in fields
    }
