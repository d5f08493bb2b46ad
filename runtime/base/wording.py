"""Numbers with their nouns, for summaries."""


def plural(count: int, what: str) -> str:
    """Return a number with its noun, such as "1 part" and "2,000 parts"."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"


def at_normals(used: int, requested: int) -> str:
    """Return a phrase such as "at 3 of 5 prescribed normals", where 3 of 5 have samples."""
    part = "" if used == requested else f"{used:,} of "
    return f"at {part}{plural(requested, 'prescribed normal')}"
