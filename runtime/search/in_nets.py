"""Exact decisions whether a patch of a spline of nets has a normal, and the fields of its samples.

The signs of the forms U, V, W at a normal decide whether a patch has it (paper, Sect. 3.2). If
rounding leaves the sign of a form open, it is replaced by the sign of another quadratic form, which
is the same for both patches at this edge, up to its sign, and is evaluated on integers. It vanishes
on the boundary cone of the edge. The boundary cones of all edges at a vertex contain the normal of
this vertex, exactly. Ties are broken by an infinitesimal displacement of the normal, the same for
all patches. Thus the Gaussian images of the patches have neither gaps nor overlaps. At a pole the
images are wedges. The image of a patch with a collapsed edge is a curve, and such a patch has no
hits.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...generated import gaussian_image
from ...generated import patch as formulas
from ...generated.vectors import Vector
from ..base.aliases import Array, Flags, Indices
from ..base.formula_calls import patch, python_function, vector
from ..base.kept import kept
from ..base.tolerances import FORM_ERROR
from ..spline.joints import EDGES
from ..spline.nets import NetSpline, vectors_of_nets
from ..spline.tips import tips_of
from .exact import SAME_PLACE, Decision, first_of_each_place
from .long_integers import (
    Integers,
    displaced_forms,
    exact_forms,
    integers,
    integers_by_row,
    leading_sign,
    ratio,
    sign,
)

ALL = slice(None)
# For each of the edges u = 0, v = 0, w = 0, the permutation of the six control points of a patch
# after which this edge is the edge v = 0.
TURNED = tuple(
    (x.end, k, x.start, x.end_beside, x.middle, x.start_beside) for k, x in enumerate(EDGES)
)
# A singular point is accepted if the angle between the requested normal and the normal of the patch
# next to the point has a cosine above this.
SAME_NORMAL = 0.999
# Normals whose distance from the normal of a pole is less than this are decided by wedges. It is
# far more than the angle at which rounding of forms matters (1e-14), and far less than the size of
# Gaussian images of patches.
NEAR_POLE = 1e-9


def errors_of(spline: NetSpline) -> Array:
    """For each of the T patches, return a bound of the errors of its forms U, V, W."""
    return rounding_of(spline) + 16.0 * _largest(spline) ** 2 * spline.topology.angles


def rounding_of(spline: NetSpline, rows: Indices | slice = ALL) -> Array:
    """For each of the given patches, return a bound of the rounding of its forms U, V, W."""
    return 8.0 * _largest(spline, rows) * _rounding(spline, rows)


def flat_nets(spline: NetSpline) -> Flags:
    """Return a mask (T,) of the patches that are developable up to rounding of coordinates."""

    def flat() -> Flags:
        cubic = python_function(formulas.parabolic_cubic)(spline._patch())
        noise = _rounding(spline) * _largest(spline) ** 5
        return np.abs(np.stack(cubic)).max(axis=0) <= 64.0 * noise

    return kept(spline, "developable", flat)


def _largest(spline: NetSpline, rows: Indices | slice = ALL) -> Array:
    """For each of the given patches, return the largest 1-norm of its vectors a, b, c, d, e."""
    return np.abs(spline.vectors[rows]).sum(axis=2).max(axis=1, initial=0.0)


def _rounding(spline: NetSpline, rows: Indices | slice = ALL) -> Array:
    """For each of the given patches, return a bound of the errors of its forms n·a, …, n·e."""
    return FORM_ERROR * _largest(spline, rows) + spline.noise


def decide_in_nets(
    spline: NetSpline, patches: Indices, normals: Array, numbers: Indices
) -> Decision:
    """Decide which of the pairs (patches[k], normals[k]) are hits, by boundary cones of edges.

    `numbers[k]` is the index of the normal. The form of an edge on the boundary of the spline may
    be 0 up to its error; of such hits at one corner, one is kept.
    """
    _, *forms = python_function(formulas.forms)(spline._patch(patches), vector(normals))
    values, errors = np.stack(forms, axis=1), errors_of(spline)[patches, None]
    signs = np.where(np.abs(values) > errors, np.sign(values), 0.0).astype(np.int8)
    topology = spline.topology
    on_border = topology.on_border.reshape(-1, 3)[patches]
    inside, local = _decided(spline, patches, normals, signs)
    _decide_at_poles(spline, patches, normals, inside, local)
    which = np.flatnonzero(inside)
    local, near = local[which], ((signs == 0) & on_border)[which].any(axis=1)
    bars = np.column_stack([local[:, :2], 1.0 - local[:, 0] - local[:, 1]])
    corner = topology.corners[1][patches[which], bars.argmax(axis=1)]
    place = np.where(bars.max(axis=1) > 1.0 - SAME_PLACE, corner, -1 - np.arange(len(which)))
    keep = first_of_each_place(numbers[which], place[:, None].astype(np.float64), near)
    which, local = which[keep], local[keep]
    _, regular, _ = spline._regular_places(patches[which], local[:, :2])
    return Decision(which, np.column_stack([local, regular, 0.0 * local[:, 0]]))


def _agree(spline: NetSpline, patches: Indices, normals: Array, places: Array) -> Flags:
    """Return whether each normal agrees with the normal of its patch at the parameters `places`.

    The angle between both normals must be less than 90 degrees. At singular points, where a circle
    of directions is perpendicular to the tangents, and in patches that touch a tip, the cosine of
    the angle must be more than SAME_NORMAL.
    """
    singular, _, N = spline._regular_places(patches, places)
    tips = tips_of(spline)
    if tips is not None:
        singular |= tips.touching[patches]
    least = np.where(singular, SAME_NORMAL, 0.0) * np.linalg.norm(N, axis=1)
    return np.einsum("kx,kx->k", N, normals) > least


def _decided(
    spline: NetSpline, patches: Indices, normals: Array, signs: NDArray[np.int8]
) -> tuple[Flags, Array]:
    """Return a mask of the pairs that are hits, and their u, v and sign of K (k, 3).

    `signs` (k, 3) are those of U, V, W, and 0 where rounding leaves them open.
    """
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
    inside &= ~topology.is_point.reshape(-1, 3)[patches].any(axis=1)
    local = np.zeros((len(patches), 3))
    some = np.flatnonzero(inside)
    if len(some) == 0:
        return inside, local
    local[some, :2] = _places(spline, patches[some], normals[some])
    local[some, 2] = np.where(high[some] > 0, 1.0, -1.0)
    inside[some] = _agree(spline, patches[some], normals[some], local[some, :2])
    return inside, local


def _decide_at_poles(
    spline: NetSpline, patches: Indices, normals: Array, inside: Flags, local: Array
) -> None:
    """Decide the pairs whose normal is near that of a pole of their patch.

    Around a pole the Gaussian image of a patch is a wedge between two planes. Each plane belongs to
    an edge that ends at the pole, and contains the normals at both ends of this edge. Signs with
    respect to planes are exact, whereas the forms of the patches are rounding errors near the pole.
    The results are written to `inside` and `local`.
    """
    topology = spline.topology
    shared, fan = topology.corners
    corner = topology.pole_corner[patches]
    some = np.flatnonzero(corner >= 0)
    N = shared[fan[patches[some], corner[some]]]
    some = some[np.linalg.norm(N - normals[some], axis=1) < NEAR_POLE]
    if len(some) == 0:
        return
    at = (corner[some, None] + np.arange(3)) % 3
    whole, _ = integers(shared[fan[patches[some, None], at]])
    N, first, second = np.moveaxis(whole, 1, 0)
    planes = [_cross(N, first), _cross(second, N)]
    turns = sign((planes[0] * second).sum(axis=1))
    found = turns != 0
    for plane in planes:
        found &= _plane_signs(plane, normals[some]) == turns
    inside[some] = found
    local[some, :2] = np.eye(3)[at[:, 0], :2]
    local[some, 2] = turns


def _cross(x: Integers, y: Integers) -> Integers:
    """Return the cross products (k, 3) of integers."""
    (a, b, c), (d, e, f) = x.T, y.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)


def _places(spline: NetSpline, patches: Indices, normals: Array) -> Array:
    """Return the parameters u, v (k, 2) of the points of patches with given normals.

    They are exact quotients, rounded; parameters outside the triangle are moved to its boundary.
    """
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
    """Return the signs (k,) of the boundary cones of edges at normals (k, 3).

    Edge j of patch p has the index 3 p + j in `rows`. The control points of the patch that owns the
    joint are permuted so that the edge becomes v = 0. The tangents at its two ends are projected
    onto the tangent planes of these vertices; all patches at a vertex share one normal. The
    boundary cone is then V = 0, and the result is the sign of V, with the opposite sign for the
    other patch of the joint. For an edge with an end at a pole, see `_polar_signs`.
    """
    topology = spline.topology
    owner, side = topology.owner[0][rows], topology.owner[1][rows]
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
    polar = np.flatnonzero(topology.polar[0][owner] >= 0)
    if len(polar) > 0:
        signs[polar] = _polar_signs(spline, owner[polar], normals[polar])
    return signs * side


def _polar_signs(spline: NetSpline, rows: Indices, normals: Array) -> NDArray[np.int8]:
    """Return the signs (k,) of the boundary cones, at normals (k, 3), of edges that end at a pole.

    At the pole the tangents along and across the edge are parallel, and the form V of the edge is a
    product of two linear forms of the normal n. The first one vanishes in a plane that contains the
    normals at both ends, and thus all normals along the edge; the second one is n · tangent.
    """
    topology = spline.topology
    shared, fan = topology.corners
    end, tangent = (x[rows] for x in topology.polar)
    patches, edge = np.divmod(rows, 3)
    corners = [(edge + 1 + k) % 3 for k in (end, 1 - end)]
    whole, _ = integers(np.stack([shared[fan[patches, x]] for x in corners]))
    plane = _cross(whole[0], whole[1])
    T, X = _tangents_at(spline, rows, end)
    far_T, far_X = _tangents_at(spline, rows, 1 - end)
    share = (X * T).sum(axis=1) / (T * T).sum(axis=1)
    beside = far_X.astype(np.float64) - share[:, None].astype(np.float64) * far_T.astype(np.float64)
    towards = np.sign((beside * plane.astype(np.float64)).sum(axis=1)).astype(np.int8)
    along, _ = _tangents_at(spline, tangent, topology.polar[0][tangent])
    outwards = np.where(topology.polar[0][tangent] == 0, 1, -1).astype(np.int8)
    along = np.stack(_tangential(vector(along), whole[0]), axis=1)
    return towards * outwards * _plane_signs(plane, normals) * _plane_signs(along, normals)


def _tangents_at(spline: NetSpline, rows: Indices, end: Indices) -> tuple[Integers, Integers]:
    """Return the tangents along and across edges, each (k, 3), as integers.

    `end` (k,) is 0 for a tangent at the start of its edge, 1 at the end.
    """
    patches, edge = np.divmod(rows, 3)
    nets, _ = integers(spline.control_nets[patches])
    turned = nets[np.arange(len(rows))[:, None], np.array(TURNED)[edge]]
    vectors = np.asarray(vectors_of_nets(np.asarray(turned, dtype=object)), dtype=object)
    found = python_function(formulas.tangents)(patch(vectors), end.astype(object), 0)
    return np.stack(found[0], axis=1), np.stack(found[1], axis=1)


def _plane_signs(planes: Integers, normals: Array) -> NDArray[np.int8]:
    """Return the signs (k,) of linear forms, with coefficients (k, 3), at displaced normals."""
    n, _ = integers_by_row(normals)
    forms = [(planes.T * n).sum(axis=0), *(leading_sign(n) * planes.T)]
    signs = sign(np.array(forms, dtype=object))
    return signs[(signs != 0).argmax(axis=0), np.arange(len(planes))]


def _tangential(x: Vector, normals: Integers) -> Vector:
    """Return |n|² times the part of x perpendicular to n (k, 3), or x where n = 0."""
    found = python_function(gaussian_image.tangential)(x, vector(normals))
    none = np.asarray((normals == 0).all(axis=1, keepdims=True), dtype=bool)
    return vector(np.where(none, np.stack(x, axis=1), np.stack(found, axis=1)))


def fields_in_nets(
    spline: NetSpline,
    patches: Indices,
    normals: Array,
    exact: Indices,
    local: Array,
    fields: Sequence[str],
    dtype: DTypeLike,
) -> dict[str, NDArray[Any]]:
    """Return the requested fields of samples, one in each of the patches (k,) at normals (k, 3).

    `exact` are the indices of the samples that were decided exactly; `local` has their rows of
    `Decision.local`. Floating-point fields have the type `dtype`.
    """
    patch, n = spline._patch(patches), normals
    D, U, V, _ = python_function(formulas.forms)(patch, vector(n))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u, v = (np.array(x) for x in python_function(formulas.parameters)(D, U, V))
        u[exact], v[exact] = local[:, 0], local[:, 1]
        uv = np.stack([u, v], axis=1)
        points = spline._points_in_patches(patches, uv)
        u[exact], v[exact] = local[:, 3], local[:, 4]
        _, _, N = spline._regular_places(patches[exact], local[:, 3:5])
        at = n.copy()
        at[exact] = N / np.linalg.norm(N, axis=1, keepdims=True)
        K, H = python_function(formulas.curvature_at)(patch, vector(at), u, v)
        K, H = K * spline.scale**2, H * spline.scale
    K[exact] = np.copysign(K[exact], local[:, 2])
    arrays = {
        "points": points, "normals": n, "uv": uv,
        "support": np.einsum("kx,kx->k", n, points),
        "gaussian_curvature": K, "mean_curvature": H,
    }  # fmt: skip
    return {
        name: np.ascontiguousarray(x, dtype=dtype) for name, x in arrays.items() if name in fields
    }
