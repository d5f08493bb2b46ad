"""How well points with normals represent a part."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import KDTree

from ..peers.forms import Array
from .reference import Reference
from .ways import Cloud, File, Way

__all__ = ["Errors", "OnPart", "errors", "judged"]


@dataclass(frozen=True)
class Errors:
    """How far places of a part are from samples: distances in % of its diagonal, degrees.

    `gap` is the largest distance to the nearest sample, `normal` the largest angle to the sample
    nearest in normal, wherever it is, `mean` the mean angle to the normal of the sample nearest in
    space. Normals that are opposite count as equal.
    """

    count: int
    gap: float
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
        float(np.degrees(2.0 * np.arcsin(chords.max() / 2.0))),
        float(np.average(turned, weights=reference.areas)),
    )


def angles(left: Array, right: Array) -> Array:
    """Return the angles between lines of unit vectors in degrees, 90 at most."""
    chords = np.minimum(
        np.linalg.norm(left - right, axis=-1), np.linalg.norm(left + right, axis=-1)
    )
    return np.degrees(2.0 * np.arcsin(np.minimum(chords / 2.0, 1.0)))
