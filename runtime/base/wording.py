"""Wording of summaries."""

from __future__ import annotations


def plural(count: int, what: str) -> str:
    """Return a number with its noun, such as "1 part" and "2,000 parts"."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"


def at_normals(used: int, requested: int) -> str:
    """Return the number of prescribed normals that have samples, in words."""
    part = "" if used == requested else f"{used:,} of "
    return f"at {part}{plural(requested, 'prescribed normal')}"
