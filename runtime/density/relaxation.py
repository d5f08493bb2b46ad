"""Spreading the added samples more evenly, at more cost."""

from __future__ import annotations

from .angles import fill_widest_angles
from .cover import Cover

__all__ = ["relax"]

# The radii of the cells of candidates, relative to the covering radius.
FINE = 0.2
# This part of the added samples goes where normals are farthest from those of all samples.
FOR_NORMALS = 0.1
# This part of the others is moved; the rest fills the gaps that are widest then.
MOVED = 0.9
# Gaps are at most this much wider while samples are missing.
WIDEST = 2.0


def relax(cover: Cover, steps: int) -> None:
    """Add the samples, at least one, again among finer candidates, and move them `steps` times.

    A step moves each sample to the centre of the smallest ball around its Voronoi cell: Lloyd's
    method for the largest distance instead of the mean of the squares. If their count is given, a
    few go to the widest gaps in normal space before, and stay there; if a radius is given, there
    may be fewer samples than before.
    """
    count, widest = cover.count, WIDEST * cover.radius
    cover.remove_added()
    cover.fine = FINE
    cover.take_candidates(cover.radius, widest)
    if cover.given and cover.count_asked is not None:
        fill_widest_angles(cover, round(FOR_NORMALS * (count - cover.fixed)), widest)
    settled = cover.count
    cover.narrow(widest, cover.radius_asked, settled + round(MOVED * (count - settled)))
    for _ in range(steps):
        cover.renew_distances(widest)
        cover.move_to_centres(settled)
    cover.renew_distances(widest)
    cover.to_what_was_asked(widest)
