"""Counting sort of keys by their leading bits; it keeps the order of keys with the same ones."""

from __future__ import annotations

import numpy as np

from ...machine_code.jit import jit

__all__ = ["count_keys", "order_few", "place_keys"]


@jit
def count_keys(keys, shift, starts):
    """Add the number of keys with the leading bits b to starts[b + 1]."""
    for k in range(keys.size):
        starts[np.uint64((keys[k] >> shift) + 1)] += 1


@jit
def place_keys(keys, shift, starts, ordered):
    """Write keys to their places; `starts` are those of their leading bits, and move on."""
    for k in range(keys.size):
        b = np.uint64(keys[k] >> shift)
        ordered[np.uint64(starts[b])] = keys[k]
        starts[b] += 1


@jit
def order_few(keys):
    """Sort keys of which few are not in order, and not far from their places."""
    for k in range(1, keys.size):
        key, at = keys[k], k
        while at > 0 and keys[at - 1] > key:
            keys[at] = keys[at - 1]
            at -= 1
        keys[at] = key
