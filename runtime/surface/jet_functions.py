"""The source of the derivatives of a surface: its formulas, its user, or differences."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.aliases import Array, Flags
from ..base.errors import SurfaceError
from ..base.evaluation import returned
from ..domain.domain import Boundary, Domain
from .derivatives import NAMES, Differences, Differentiable, Function

__all__ = ["jet_function"]

Evaluation = Callable[[Array, Array], ArrayLike]

# Given derivatives are compared with numerical ones at points (i/√2, i/√3) modulo 1 of the domain.
PLACES = 48
# They may differ by TOLERANCE, relative to the largest derivative of the same order, plus DOUBT
# times the change of the numerical ones when their steps are doubled.
TOLERANCE = 1e-5
DOUBT = 10.0


def jet_function(
    function: Evaluation,
    derivatives: Evaluation | None,
    domain: Domain,
    boundary: Boundary,
    name: str,
) -> Function:
    """Return the function of u (k,) and v (k,) that gives the 2-jets (k, 6, 3) of a surface."""
    own = function if isinstance(function, Differentiable) and function.differentiable else None
    if derivatives is None and own is not None and not own.has_gaps:
        return own.jets
    label = f"surface {name!r}"
    numerical = Differences(guarded(function, (3,), f"the callable of {label}"), domain, boundary)
    if derivatives is not None:
        given = guarded(derivatives, (len(NAMES), 3), f"derivatives of {label}")
        compare(given, numerical, label)
        return given
    return numerical.jets if own is None else filled(own, numerical)


def guarded(function: Evaluation, shape: tuple[int, ...], label: str) -> Function:
    """Return a user's callable with checked results, which only one thread calls at a time.

    It raises SurfaceError unless the callable returns an array of `shape` for each parameter pair.
    """
    lock = threading.RLock()

    def call(u: Array, v: Array) -> Array:
        with lock:
            return returned(function, (u, v), shape, label)

    return call


def filled(function: Differentiable, numerical: Differences) -> Function:
    """Return the derivatives of a formula, with numerical ones where they are not finite."""

    def jets(u: Array, v: Array) -> Array:
        found = function.jets(u, v)
        bad = ~np.isfinite(found).all(axis=(1, 2))
        if bad.any():
            found[bad] = numerical.jets(u[bad], v[bad])
        return found

    return jets


def compare(derivatives: Function, numerical: Differences, label: str) -> None:
    """Raise SurfaceError if derivatives are not finite, or not those of the function.

    The message has the derivative, the parameters, and the difference.
    """
    steps = np.arange(1, PLACES + 1)
    u, v = (
        low + (high - low) * (np.sqrt(x) * steps % 1.0)
        for x, (low, high) in zip((0.5, 1 / 3), numerical.domain, strict=True)
    )
    coarser = replace(numerical, step=2.0 * numerical.step)
    given, found, coarse = derivatives(u, v), numerical.jets(u, v), coarser.jets(u, v)
    known = np.logical_and.reduce(np.isfinite(found) & np.isfinite(coarse), axis=-1)
    sizes = np.abs(np.where(known[..., None], found, 0.0)).max(axis=(0, 2))
    with np.errstate(invalid="ignore"):
        error: Array = np.abs(given - found).max(axis=-1)
        allowed = TOLERANCE * sizes + DOUBT * np.abs(found - coarse).max(axis=-1)
        wrong: Flags = known & ~(error <= allowed)
    if wrong.any():
        order = int(np.argmax(wrong.any(axis=0)))  # the first wrong one explains the others
        place = int(np.argmax(np.where(wrong, error, -1.0)[:, order]))
        raise SurfaceError(
            f"derivatives of {label} contradict it: {NAMES[order]} at u = {float(u[place])}, v = "
            f"{float(v[place])} is given as {given[place, order]}, and differences of points give "
            f"{found[place, order]}, {error[place, order]:.2g} away."
        )
