"""How well points with normals represent a surface: angles and distances over many places."""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .forms import Array, ClosedForm
from .recipe import draw

PLACES = 200_000
# samples (N, 3), places (M, 3) → which sample is nearest to each place, (M,)
Nearest = Callable[[Array, Array], np.ndarray]


def nearest_by_tree(samples: Array, places: Array) -> np.ndarray:
    """Return which sample is nearest to each place, by SciPy's k-d tree."""
    from scipy.spatial import KDTree

    return np.asarray(KDTree(samples).query(places, workers=-1)[1])


@dataclass(frozen=True)
class Places:
    """Places on a surface, uniform by area, where samples are judged."""

    points: Array
    normals: Array
    hyperbolic: np.ndarray

    @classmethod
    def of(cls, form: ClosedForm, count: int = PLACES) -> Places:
        """Draw the places."""
        u, v = draw(form, count, form.area, seed=7)
        return cls(*form.evaluate(u, v), hyperbolic=form.curvature(u, v) < 0.0)


def angles(left: Array, right: Array) -> Array:
    """Return the angles between unit vectors in degrees, accurate when they are small."""
    chord = np.linalg.norm(left - right, axis=-1)
    return np.degrees(2.0 * np.arcsin(np.minimum(chord / 2.0, 1.0)))


def worst_in_normal(
    places: Places, normals: Array, hyperbolic: np.ndarray, nearest: Nearest
) -> float:
    """G: the largest angle to the sample nearest in normal that has the same sign of K.

    180 degrees if a sign has places and no sample.
    """
    worst = 0.0
    for sign in (False, True):
        asked, samples = places.normals[places.hyperbolic == sign], normals[hyperbolic == sign]
        if len(asked) and not len(samples):
            return 180.0
        if len(asked):
            found = samples[nearest(samples, asked)]
            worst = max(worst, float(angles(asked, found).max()))
    return worst


@dataclass(frozen=True)
class Errors:
    """How far places of a surface are from samples: angles in degrees, distances in its unit.

    `E` is the largest, `mean` the mean angle between the normals of a place and of the sample
    nearest in space; `gap` is the largest distance to that sample, `plane` to its tangent plane.
    `G` is the largest angle to the sample nearest in normal with the same sign of K.
    """

    E: float
    mean: float
    G: float
    gap: float
    plane: float


def errors(
    form: ClosedForm, places: Places, points: Array, normals: Array, nearest: Nearest
) -> Errors:
    """Judge samples; normals that point to the other side are all turned first."""
    u, v = form.parameters(points)
    if np.einsum("nx,nx->n", form.evaluate(u, v)[1], normals).mean() < 0.0:
        normals = -normals
    hyperbolic = form.curvature(u, v) < 0.0
    found = nearest(points, places.points)
    turned = angles(places.normals, normals[found])
    away = places.points - points[found]
    return Errors(
        E=float(turned.max()),
        mean=float(turned.mean()),
        G=worst_in_normal(places, normals, hyperbolic, nearest),
        gap=float(np.linalg.norm(away, axis=1).max()),
        plane=float(np.abs(np.einsum("nx,nx->n", away, normals[found])).max()),
    )


def both(
    form: ClosedForm, places: Places, points: Array, normals: Array, nearest: Nearest
) -> tuple[float, float]:
    """Return E and G of samples."""
    found = errors(form, places, points, normals, nearest)
    return found.E, found.G
