"""Numbers that are repeated, each as often as a count says."""

from __future__ import annotations

import numpy as np

from .aliases import Indices

__all__ = ["repeated"]


def repeated(counts: Indices) -> tuple[Indices, Indices]:
    """Return each index k of counts (n,) counts[k] times, and beside it 0 … counts[k] − 1."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]
