"""Spreading samples that were added further, at more cost."""

from __future__ import annotations

from .angles import widest_angles
from .cover import Cover

__all__ = ["relax"]

# Candidates are the middles of triangles that reach so far, beside the radius.
FINE = 0.2
# So many of the samples that are added go where normals are farthest from those of all samples.
FOR_NORMALS = 0.1
# So many of the others are moved; what is left fills the gaps that are widest then.
MOVED = 0.9
# Gaps are that much wider at most while samples are missing.
WIDEST = 2.0


def relax(cover: Cover, steps: int) -> None:
    """Add the samples, at least one, again among finer candidates, and move them `steps` times.

    A step moves each to the middle of all places that it is nearest to, the centre of the smallest
    ball around them: Lloyd's method, for the largest distance instead of the mean of the squares.
    If their count is given, a few go to the widest gaps in normal space before, and stay there; if
    a radius is given, fewer samples may come than before.
    """
    count, widest = cover.count, WIDEST * cover.radius
    cover.forget()
    cover.fine = FINE
    cover.take_candidates(cover.radius, widest)
    if cover.given and cover.most is not None:
        widest_angles(cover, round(FOR_NORMALS * (count - cover.given)), widest)
    settled = cover.count
    cover.narrow(widest, cover.least, settled + round(MOVED * (count - settled)))
    for _ in range(steps):
        cover.tell_again(widest)
        cover.centre(settled)
    cover.tell_again(widest)
    cover.to_what_was_asked(widest)
