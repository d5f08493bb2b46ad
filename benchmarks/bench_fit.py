"""Fitting: cells and patches per second, for a surface with a formula and for a grid of values."""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.spline.kernels import spline as kernels

TORUS = gm.surfaces.torus()
SIZES = pytest.mark.parametrize("size", [64, 512])
ROUNDS = {64: 51, 512: 9}


def values(size, *, centres=False):
    """The torus at the size² centres, or at the (size + 1)² vertices, of its cells."""
    lines = np.arange(size) + 0.5 if centres else np.arange(size + 1.0)
    (u0, u1), (v0, v1) = TORUS.domain
    u, v = u0 + (u1 - u0) * lines / size, v0 + (v1 - v0) * lines / size
    return TORUS.evaluate(u[:, None], v)


def units(size):
    return {"cells": size**2, "patches": 4 * size**2}


def copying(*arrays):
    """The limit of a loop that reads arrays once: copying them into allocated memory."""
    copies = [x.copy() for x in arrays]

    def copy():
        for source, target in zip(arrays, copies, strict=True):
            np.copyto(target, source)

    return copy


@SIZES
def test_fit_torus(compare, size):
    def evaluate():
        return values(size), values(size, centres=True)

    compare(
        lambda: gm.fit(TORUS, (size, size)),
        baselines={"evaluate": evaluate},
        units=units(size),
        rounds=ROUNDS[size],
    )


@SIZES
def test_fit_grid(compare, size):
    surface = gm.Surface.from_grid(values(size)[:-1, :-1], periodic=(True, True))
    points = surface.grid
    compare(
        lambda: gm.fit(surface),
        baselines={"copying_input": copying(points)},
        units=units(size),
        rounds=ROUNDS[size],
    )


@SIZES
def test_kernel_of_centres_and_vertices(compare, size):
    centres, vertices = values(size, centres=True), values(size)
    coefficients = np.empty((size, size, 3))
    compare(
        lambda: kernels.fit_centres_and_vertices(centres, vertices, coefficients),
        baselines={"copying_input": copying(centres, vertices)},
        units=units(size),
        rounds=ROUNDS[size],
    )


@SIZES
def test_kernel_of_vertices(compare, size):
    ringed = np.pad(values(size)[:-1, :-1], ((1, 2), (1, 2), (0, 0)), mode="wrap")
    coefficients = np.empty((size, size, 3))
    compare(
        lambda: kernels.fit_vertices(ringed, coefficients),
        baselines={"copying_input": copying(ringed)},
        units=units(size),
        rounds=ROUNDS[size],
    )
