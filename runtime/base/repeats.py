"""Indices that are repeated, each as often as its count says."""

import numpy as np

from .aliases import Indices


def repeated(counts: Indices) -> tuple[Indices, Indices]:
    """Return two arrays: each index k of counts (n,) repeated counts[k] times, and a counter.

    The counter goes from 0 to counts[k] − 1 for each k.
    """
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]
