"""Wording of summaries."""

from __future__ import annotations

__all__ = ["plural"]


def plural(count: int, what: str) -> str:
    """Return a number with its noun, such as "1 part" and "2,000 parts"."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"
