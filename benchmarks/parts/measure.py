"""How well points with normals represent a part."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import KDTree

from ..peers.forms import Array
from .reference import Reference
from .ways import Cloud, File, Way

__all__ = ["Errors", "OnPart", "errors", "judged"]

# Normals on one side are within this angle. The nearest sample on a side is looked for among this
# many times as many neighbours, until one is found.
SIDE, MORE = 60.0, 4
# The normal of a sample gets the sign of the nearest of this many places whose normal is parallel
# to it, up to this cosine.
PLACES, ALIKE = 16, 0.9


@dataclass(frozen=True)
class Errors:
    """How far places of a part are from samples: distances in % of its diagonal, degrees.

    `gap` is the largest distance to the nearest sample, `side` that to the nearest one on the same
    side, `normal` the largest angle to the sample nearest in normal, wherever it is, `mean` the
    mean angle to the normal of the sample nearest in space. Normals that are opposite count as
    equal; which side is meant, the places around a sample say.
    """

    count: int
    gap: float
    side: float
    normal: float
    mean: float


@dataclass(frozen=True)
class OnPart:
    """What was found on a part: errors by ways, or why one failed.

    Constants of gaussmap were chosen on the parts that are not held out.
    """

    name: str
    faces: int
    count: int
    held_out: bool
    found: dict[Way, Errors | str] = field(default_factory=dict)


def judged(file: File, reference: Reference, way: Way) -> Errors | str:
    """Judge a way, or say why it fails."""
    try:
        clouds = way.clouds(file)
    except ImportError as error:
        return f"missing: {error}"
    except Exception as error:  # of Gmsh
        return f"fails: {error}"
    if not clouds:
        return "fails: no mesh has about that count"
    return min((errors(reference, x) for x in clouds), key=lambda x: x.gap * x.normal)


def errors(reference: Reference, cloud: Cloud) -> Errors:
    """Judge points by the places of a reference."""
    distances, nearest = KDTree(cloud.points).query(reference.points, workers=-1)
    turned = np.nanmin(angles(reference.normals[:, None], cloud.normals[nearest]), axis=1)
    normals = cloud.normals.reshape(-1, 3)
    normals = np.unique(normals[np.isfinite(normals).all(axis=1)].round(9), axis=0)
    both = KDTree(np.concatenate([normals, -normals]))
    chords, _ = both.query(np.unique(reference.normals.round(9), axis=0), workers=-1)
    return Errors(
        len(cloud),
        100.0 * float(distances.max()) / reference.diagonal,
        100.0 * float(same_side(reference, cloud).max()) / reference.diagonal,
        float(np.degrees(2.0 * np.arcsin(chords.max() / 2.0))),
        float(np.average(turned, weights=reference.areas)),
    )


def same_side(reference: Reference, cloud: Cloud) -> Array:
    """Return the distances of places from the nearest sample with a normal within SIDE degrees.

    A sample with several normals is on the sides of all of them. Infinite if there is none.
    """
    normals = oriented(reference, cloud)
    tree, least = KDTree(cloud.points), np.cos(np.radians(SIDE))
    found, left = np.full(len(reference.points), np.inf), np.arange(len(reference.points))
    many = 1
    while len(left) and many < MORE * len(cloud):
        near = tree.query(reference.points[left], min(many, len(cloud)), workers=-1)
        distances, rows = (x.reshape(len(left), -1) for x in near)
        cosines = np.einsum("pknx,px->pkn", normals[rows], reference.normals[left])
        on_side = (np.nan_to_num(cosines, nan=-1.0) >= least).any(axis=2)
        found[left] = np.where(on_side, distances, np.inf).min(axis=1)
        left, many = left[np.isinf(found[left])], MORE * many
    return found


def oriented(reference: Reference, cloud: Cloud) -> Array:
    """Return the normals (N, k, 3) of samples with the signs of normals of places around them."""
    near = KDTree(reference.points).query(cloud.points, min(PLACES, len(reference.points)))[1]
    cosines = np.einsum("nkx,npx->nkp", cloud.normals, reference.normals[near])
    alike = np.abs(np.nan_to_num(cosines)) >= ALIKE
    first = np.take_along_axis(cosines, alike.argmax(axis=2)[..., None], axis=2)
    return np.where(alike.any(axis=2)[..., None] & (first < 0.0), -1.0, 1.0) * cloud.normals


def angles(left: Array, right: Array) -> Array:
    """Return the angles between lines of unit vectors in degrees, 90 at most."""
    chords = np.minimum(
        np.linalg.norm(left - right, axis=-1), np.linalg.norm(left + right, axis=-1)
    )
    return np.degrees(2.0 * np.arcsin(np.minimum(chords / 2.0, 1.0)))
