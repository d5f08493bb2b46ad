"""Which triangles of a mesh share an edge."""

from __future__ import annotations

from ...runtime.kernels.jit import inline, jit

__all__ = ["link_triangles"]


@inline
def ends_of(triangles, edge):
    """Return the smaller and the larger vertex of edge 3 t + k, opposite to corner k of t."""
    a = triangles[edge // 3, (edge + 1) % 3]
    b = triangles[edge // 3, (edge + 2) % 3]
    return min(a, b), max(a, b)


@inline
def starts_of(starts):
    """Replace the numbers of members of each group by the first places of the groups."""
    total = 0
    for k in range(starts.size):
        members = starts[k]
        starts[k] = total
        total += members


@jit
def link_triangles(triangles, may_end, starts, by_end, order, neighbours):
    """Write the triangles (k, 3) opposite to the corners; return whether the mesh is closed.

    The neighbour is −1 (which the output must hold on entry) where an edge is in one triangle, or
    in three or more. A mesh is closed if no edge is in three, and edges in one are between vertices
    that `may_end` (vertices,). `starts` (vertices,), `by_end` and `order` (3 k,) are workspace.
    """
    edges = order.size
    for k in range(starts.size):
        starts[k] = 0
    for edge in range(edges):
        starts[ends_of(triangles, edge)[1]] += 1
    starts_of(starts)
    for edge in range(edges):
        end = ends_of(triangles, edge)[1]
        by_end[starts[end]] = edge
        starts[end] += 1
    for k in range(starts.size):
        starts[k] = 0
    for edge in range(edges):
        starts[ends_of(triangles, edge)[0]] += 1
    starts_of(starts)
    for k in range(edges):
        first = ends_of(triangles, by_end[k])[0]
        order[starts[first]] = by_end[k]
        starts[first] += 1
    closed = True
    linked = False
    k = 0
    while k < edges:
        a, b = ends_of(triangles, order[k])
        last = k + 1
        while last < edges and ends_of(triangles, order[last]) == (a, b):
            last += 1
        if last == k + 2:
            one, other = order[k], order[k + 1]
            neighbours[one // 3, one % 3] = other // 3
            neighbours[other // 3, other % 3] = one // 3
            linked = True
        else:
            closed = closed and last == k + 1 and may_end[a] and may_end[b]
        k = last
    return closed and linked
