"""Packed hits, number of a normal << 32 | its position in the order of bins."""

from __future__ import annotations

from ..machine_code.jit import inline, jit, loop

__all__ = ["insertion_sort", "merge_hits", "pack_hits", "store_sorted"]

# Up to this many are sorted by insertion.
FEW = 32


@loop
def pack_hits(codes, code, numbers, places, hits, count):
    """Write a packed hit for each candidate with the code; return their number."""
    chosen = 0
    for k in range(count):
        hits[chosen] = int(numbers[k]) << 32 | places[k]
        chosen += codes[k] == code
    return chosen


@loop
def store_sorted(hits, count, scratch, starts, patch, rows, at):
    """Sort hits and write patch and hit of each to rows (…, 2) from `at` on; return the end."""
    if count <= FEW:
        insertion_sort(hits, count)
    else:
        hits = radix_sort(hits, count, scratch, starts)
    for k in range(count):
        rows[at + k, 0] = patch
        rows[at + k, 1] = hits[k]
    return at + count


@inline
def insertion_sort(hits, count):
    """Sort a few hits."""
    for k in range(1, count):
        hit = hits[k]
        at = k
        while at > 0 and hits[at - 1] > hit:
            hits[at] = hits[at - 1]
            at -= 1
        hits[at] = hit


@inline
def radix_sort(hits, count, scratch, starts):
    """Sort hits by the numbers of normals: a radix sort with about as many digits as hits."""
    low = high = hits[0] >> 32
    for k in range(count):
        low = min(low, hits[k] >> 32)
        high = max(high, hits[k] >> 32)
    width = 1
    while 2 << width <= count:
        width += 1
    mask = (1 << width) - 1
    shift = 0
    while (high - low) >> shift > 0:
        for k in range(mask + 2):
            starts[k] = 0
        for k in range(count):
            starts[((((hits[k] >> 32) - low) >> shift) & mask) + 1] += 1
        for k in range(mask + 1):
            starts[k + 1] += starts[k]
        for k in range(count):
            digit = (((hits[k] >> 32) - low) >> shift) & mask
            scratch[starts[digit]] = hits[k]
            starts[digit] += 1
        hits, scratch = scratch, hits
        shift += width
    return hits


@jit
def merge_hits(certain, decided, merged, places):
    """Merge rows (…, 2) of patch and packed hit; write the rows of decided ones to places."""
    at = 0
    end = certain.shape[0]
    count = decided.shape[0]
    for k in range(count + 1):
        while at < end and (
            k == count
            or certain[at, 0] < decided[k, 0]
            or (certain[at, 0] == decided[k, 0] and certain[at, 1] < decided[k, 1])
        ):
            merged[at + k, 0] = certain[at, 0]
            merged[at + k, 1] = certain[at, 1]
            at += 1
        if k < count:
            places[k] = at + k
            merged[at + k, 0] = decided[k, 0]
            merged[at + k, 1] = decided[k, 1]
