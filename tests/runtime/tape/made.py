"""What kernels of tapes find over boxes, and NURBS graphs, for tests."""

from collections.abc import Callable
from itertools import product
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.runtime.tape.kernels.balls import BALL, bounds_of_boxes
from gaussmap.runtime.tape.kernels.points import POINT, Tape, points_jets
from gaussmap.runtime.tape.kernels.rounding import rounding_of_boxes

ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


def tape_of(surface: gm.Surface) -> Tape:
    assert surface.tape is not None
    return surface.tape


def registers(tape: Tape) -> np.ndarray:
    return np.empty(BALL * (len(tape.operations) + 1))


def jets_at(tape: Tape, places: np.ndarray) -> np.ndarray:
    """Return the Taylor coefficients (k, 6, 3) at places (k, 2)."""
    jets = np.empty((len(places), 6, 3))
    u_values, v_values = (np.ascontiguousarray(x) for x in places.T)
    points_jets(tape, u_values, v_values, np.empty(POINT * len(tape.operations)), jets)
    return jets / np.array([1, 1, 1, 2, 1, 2])[:, None]


def balls_on(tape: Tape, centres: np.ndarray, widths: np.ndarray, order: int = 3) -> np.ndarray:
    """Return midpoints and radii (k, 2, 10, 3) of the Taylor coefficients on boxes."""
    bounds = np.empty((len(centres), 2, 10 if order == 3 else 6, 3))
    ends = np.empty((2, 4))
    bounds_of_boxes(tape, order, centres, widths, registers(tape), registers(tape), ends, bounds)
    return bounds


def errors_on(tape: Tape, centres: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """Return bounds (k, 6, 3) of the rounding errors of coefficients at points of boxes."""
    bounds, ends = np.empty((len(centres), 6, 3)), np.empty((2, 4))
    middles, radii, errors = (registers(tape) for _ in range(3))
    rounding_of_boxes(tape, centres, widths, middles, radii, errors, ends, bounds)
    return bounds


def check(tape: Tape, exact: Callable[..., Any], found: tuple[np.ndarray, ...]) -> None:
    """Assert that bounds hold at places of boxes; `exact` returns coefficients (10, 3) there."""
    centres, widths, places = found
    balls = balls_on(tape, centres, widths).astype(object)
    errors = errors_on(tape, centres, widths).astype(object)
    jets = jets_at(tape, places).astype(object)
    for k, place in enumerate(places.tolist()):
        values, (middles, radii) = exact(*place), balls[k]
        known = np.isfinite(radii.astype(np.float64))
        assert (abs(values - middles)[known] <= radii[known]).all(), place
        assert (abs(values[:6] - jets[k]) <= errors[k]).all(), place


def used_radii(balls: np.ndarray, exact: Callable[..., Any], *boxes: np.ndarray) -> np.ndarray:
    """Return the largest errors at corners of boxes, relative to the radii of balls."""
    centres, widths = boxes
    used = np.zeros(balls[:, 1].shape)
    for signs in product((-1, 1), repeat=2):
        for k, place in enumerate((centres + np.array(signs) * widths).tolist()):
            off = np.abs(exact(*place).astype(np.float64) - balls[k, 0])
            used[k] = np.maximum(used[k], off / (balls[k, 1] + 1e-300))
    return used


def boxes(low: Any, high: Any, width: Any, count: int, seed: int) -> tuple[np.ndarray, ...]:
    """Return centres and half widths of boxes (k, 2), and a place in each, often a corner."""
    generator = np.random.default_rng(seed)
    centres = generator.uniform(low, high, (count, 2))
    widths = np.broadcast_to(width, (count, 2)).copy()
    shares = generator.uniform(-1.0, 1.0, (count, 2))
    shares = np.where(generator.random((count, 2)) < 0.5, np.sign(shares), shares)
    # One unit of the last place inwards, as rounding could take a place out of its box.
    return centres, widths, np.nextafter(centres + shares * widths, centres)


def graph(degrees: tuple[int, int], knots: tuple[float, ...], rational: bool) -> gm.Surface:
    """Return a NURBS graph with random heights over [0, 2] × [0, 2]."""
    random = np.random.default_rng(3)
    vectors = [[0.0] * (p + 1) + [*knots] + [2.0] * (p + 1) for p in degrees]
    m, n = (len(knots) + p + 1 for p in degrees)
    x, y = np.meshgrid(np.linspace(0, 2, m), np.linspace(0, 1, n), indexing="ij")
    points = np.stack([x, y, 0.2 * random.normal(size=x.shape)], axis=-1) + 3.0
    weights = random.uniform(0.5, 2.0, (m, n)) if rational else None
    return gm.Surface.from_nurbs(degrees, vectors, points, weights)
