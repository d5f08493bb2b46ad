"""Connected sets of points of a spline with the same normal: curves, regions and flat points.

In a patch, n·p_u and n·p_v are linear in u and v. If the matrix of their derivatives has rank 1,
both may be 0 on a line: all its points have the normal n or −n. Exact arithmetic makes some points
of such a line hits, or none. Here each connected set of lines becomes one hit, and so do several
hits at one point, such as a flat point where patches meet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...generated import patch as formulas
from ...generated.spline import CORNERS as OUTER
from ..base.aliases import Array, Flags, Indices
from ..base.formula_calls import python_function, vector
from ..base.tolerances import FORM_ERROR, SINGULAR_POINT
from ..samples.fields import Component
from ..spline.joints import linked
from ..spline.nets import AnySpline, NetSpline
from .hits import SIGN, Hits
from .kernels.lists import NUMBER

# Normals are displaced by BESIDE times the rounding error of coordinates, which turns normals by
# angles of about its own size. DIRECTION is in no usual plane of symmetry.
BESIDE, DIRECTION = 64.0, np.array([1.0, 1e-2, 1e-4])
# Points of a patch that are closer than this to a corner or an edge, in u and v, count as on it.
TOUCHING = 1e-6
# The parameters u, v of the corners of a patch, and of its centre.
CORNERS, CENTRE = np.eye(3)[:, :2], np.full(2, 1.0 / 3.0)
# For each edge, the corners at its start and its end. The indices of the control points at corners,
# followed by the middle control points of edges.
NEXT, LAST = [1, 2, 0], [2, 0, 1]
NODES = [0, 1, 2, 5, 4, 3]


class Lines(NamedTuple):
    """Lines, points or whole patches on which the normal is constant, one for each of `keys`.

    A key is (index of the normal) << 32 | index of the patch. `touched` (k, 6) says which corners
    and edges of its patch a line touches. `at` (k, 2) are u and v at the middle of the line. `ends`
    (k,) is 2 for a line, 1 for a point, 3 for a whole patch, and 0 if the line misses its patch.
    """

    keys: Indices
    touched: Flags
    at: Array
    ends: Indices


def lines_of(spline: AnySpline, keys: Indices, normals: Array) -> Lines:
    """Return the lines of the pairs `keys`; `normals` are those of the search.

    The normals along a line equal that of the pair up to the rounding of coordinates. Patches with
    a singular corner, at poles and tips, are left out.
    """
    patch, n = spline._patch(keys & NUMBER), normals[keys >> 32]
    A, B, C, P, Q = forms = python_function(formulas.linear_forms)(patch, vector(n))
    largest = np.abs(np.stack([np.stack(x) for x in patch[:5]])).sum(axis=1).max(axis=0)
    error = FORM_ERROR * largest + spline.noise
    # The determinant is the product of both eigenvalues, of which one must be at most `error`.
    near = np.abs(A * C - B * B) <= error * (np.abs(A) + 2.0 * np.abs(B) + np.abs(C))
    (A, B, C, P, Q), error, keys, n = np.stack(forms)[:, near], error[near], keys[near], n[near]
    values, axes = np.linalg.eigh(np.moveaxis(np.array([[A, B], [B, C]]), 2, 0))
    slopes = np.einsum("kij,ik->kj", axes, np.stack([P, Q]))
    order = np.argsort(np.abs(values), axis=1)
    (flat, steep), (along, across) = (
        np.take_along_axis(x, order, axis=1).T for x in (values, slopes)
    )
    axis = np.take_along_axis(axes, order[:, None], axis=2)[..., 1]
    near = (np.abs(flat) <= error) & (np.abs(along) <= error)
    keys, n, error, axis = keys[near], n[near], error[near], axis[near]
    steep, across = steep[near], across[near]
    with np.errstate(divide="ignore", invalid="ignore"):
        # The distances of the corners from the line, and half the width of the line.
        away = np.stack([axis[:, 0], axis[:, 1], 0.0 * steep], axis=1) + (across / steep)[:, None]
        corners = ~(np.abs(away) > (TOUCHING + error / np.abs(steep))[:, None])
    crossing = ~(corners[:, NEXT] | corners[:, LAST]) & (away[:, NEXT] * away[:, LAST] < 0.0)
    start, end = (np.where(crossing, np.abs(away[:, x]), 0.0) for x in (NEXT, LAST))
    share = np.divide(start, start + end, out=start, where=crossing)
    bars = corners + share[:, NEXT] + (crossing - share)[:, LAST]
    ends = corners.sum(axis=1) + crossing.sum(axis=1)
    bars[ends == 0] = 1.0
    at = (bars / bars.sum(axis=1, keepdims=True))[:, :2]
    places = np.concatenate([at, np.repeat([*CORNERS, CENTRE], len(at), axis=0)])
    N = spline._cross_products(np.tile(keys & NUMBER, 5), places).reshape(5, -1, 3)
    lengths = np.linalg.norm(N, axis=2)
    found = np.einsum("kx,kx->k", N[0], n) > 0.0
    found &= (lengths[:4] > SINGULAR_POINT * lengths[4]).all(axis=0)
    touched = np.concatenate([corners, crossing | corners[:, NEXT] | corners[:, LAST]], axis=1)
    return Lines(keys[found], touched[found], at[found], ends[found])


def points_of(hits: Hits, which: Indices) -> Lines:
    """Return exactly decided hits, of indices `which` in `hits.exact`, as single points."""
    at = hits.local[which, :2]
    bars = np.column_stack([at, 1.0 - at.sum(axis=1)])
    touched = np.concatenate([bars >= 1.0 - TOUCHING, bars <= TOUCHING], axis=1)
    return Lines(hits.keys[hits.exact[which]], touched, at, np.ones(len(at), np.int64))


def meeting(spline: AnySpline, hits: Hits) -> Indices:
    """Return the indices of normals with several exactly decided hits at one corner or edge."""
    numbers = hits.normal_index[hits.exact]
    again = numbers[1:] == numbers[:-1]
    points = points_of(hits, np.flatnonzero(np.append(again, False) | np.append(False, again)))
    row, place = np.nonzero(points.touched)
    nodes, _ = nodes_of(spline, points.keys & NUMBER)
    keys = np.sort(points.keys[row] >> 32 << 32 | nodes[row, place])
    return keys[1:][keys[1:] == keys[:-1]] >> 32


def beside_lines(spline: NetSpline, normals: Array) -> Array:
    """Return displaced unit normals (k, 3); opposite normals are displaced to opposite ones."""
    first = np.take_along_axis(normals, (normals != 0.0).argmax(axis=1)[:, None], axis=1)
    moved = normals + BESIDE * spline.noise * np.sign(first) * DIRECTION
    return moved / np.linalg.norm(moved, axis=1, keepdims=True)


def with_components(
    spline: AnySpline, hits: Hits, lines: Lines, numbers: Indices, counted: Hits
) -> Hits:
    """Return the hits with one hit for each connected set of lines, and of hits at one point.

    Only the normals with the indices `numbers` have such sets. The index of a set is the sum of the
    signs of K of its hits, or, for a set with lines, of the hits of displaced normals, `counted`,
    in it. The index of lines that touch the border is unknown; it is set to 0.
    """
    own, which = (
        np.flatnonzero(np.isin(x.normal_index[x.exact], numbers)) for x in (hits, counted)
    )
    parts = lines, points_of(hits, own), points_of(counted, which)
    first, last = len(lines.keys), len(lines.keys) + len(own)
    every = Lines(
        np.concatenate([x.keys for x in parts]), np.concatenate([x.touched for x in parts]),
        np.concatenate([x.at for x in parts]), np.concatenate([x.ends for x in parts]),
    )  # fmt: skip
    nodes, border = nodes_of(spline, every.keys & NUMBER)
    group = _connected(every, nodes)
    count = int(group.max(initial=-1)) + 1
    most = np.full(count, -1)  # the largest number of ends of a line in each set
    np.maximum.at(most, group[:first], lines.ends)
    degree, beside = (
        np.bincount(group[rows], x.local[k, SIGN], count)
        for rows, x, k in ((slice(first, last), hits, own), (slice(last, None), counted, which))
    )
    outer = np.zeros(count, np.bool_)
    outer[group[(every.touched & border).any(axis=1)]] = True
    degree = np.where(most < 0, degree, beside * ~outer)
    special = (most >= 0) | (np.bincount(group[first:last], minlength=count) > 1)
    # The first of the lines with most ends represents its set; without lines, the first hit does.
    rows = np.lexsort(
        (every.keys[:last], -every.ends[:last], np.arange(last) >= first, group[:last])
    )
    rows = rows[np.diff(group[rows], prepend=-1) != 0]
    rows = rows[(special & (most != 0))[group[rows]]]
    kinds = np.where(most > 1, Component.CURVE, Component.ISOLATED)
    where, at = group[rows], every.at[rows]
    local = np.column_stack([at, degree[where], at, kinds[where]])
    gone = hits.exact[own[special[group[first:last]]]]
    found = Hits(every.keys[rows], np.arange(len(rows)), local, hits.developable)
    return hits.rows(np.delete(np.arange(len(hits)), gone)).merged(found)


def nodes_of(spline: AnySpline, patches: Indices) -> tuple[Indices, Flags]:
    """Return a number for each corner and edge (k, 6) of patches, and whether it is on the border.

    A corner or edge of several patches has the same number in all of them. Creases belong to the
    border.
    """
    if isinstance(spline, NetSpline):
        numbers, edges = spline.triangles[:, NODES], spline.topology.on_border.reshape(-1, 3)
        ends = np.concatenate([numbers[:, x][edges] for x in (NEXT, LAST)])
        border = np.concatenate([np.isin(numbers[patches, :3], ends), edges[patches]], axis=1)
        return numbers[patches], border
    cell, turn = np.divmod(patches, 4)
    corners = np.concatenate([OUTER, np.zeros((4, 1, 2))], axis=1)
    places = np.concatenate([corners, (corners[:, NEXT] + corners[:, LAST]) / 2.0], axis=1)
    shifts = np.moveaxis(4.0 * (places + 0.5), 2, 0).astype(np.int64)
    at = 4 * np.stack(np.divmod(cell, spline.cells[1]))[:, :, None] + shifts[:, turn]
    border = np.zeros(at[0].shape, np.bool_)
    for axis, (ends, count) in enumerate(zip(spline.boundary, spline.cells, strict=True)):
        for end, kind in zip((0, 4 * count), ends, strict=True):
            here = at[axis] == end
            border |= here & (kind == "open")
            at[1 - axis, here & (kind == "pole")] = 0
        if ends[0] == "periodic":
            at[axis] %= 4 * count
    return at[0] * (4 * spline.cells[1] + 1) + at[1], border


def _connected(lines: Lines, nodes: Indices) -> Indices:
    """Return the number of the connected set of each line.

    Lines of one normal are connected if they are in the same patch, or touch the same corner or
    edge. `nodes` (k, 6) are the numbers of the corners and edges of their patches, see `nodes_of`.
    """
    row, place = np.nonzero(lines.touched)
    shared = lines.keys[row] >> 32 << 32 | nodes[row, place]
    _, other = np.unique(np.concatenate([~lines.keys, shared]), return_inverse=True)
    count = len(lines.keys)
    one = np.concatenate([np.arange(count), row])
    return linked(count + len(other), one, count + other)[1][:count]
