"""Tables, numbers and lists in the Markdown of pages that are written by scripts."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Sequence


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]], others: str = "--:") -> str:
    """Return a table in Markdown, its first column aligned left and the others right."""
    lines = [header, [":--", *[others] * (len(header) - 1)], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def wrapped(text: str) -> str:
    """Break paragraphs and items of a list at 100 characters, but not in formulas or links."""
    whole = re.sub(r"\$`.*?`\$", lambda found: found[0].replace(" ", "\0"), text.rstrip("\n"))
    parts = re.split(r"(\n(?=- )|\n\n)", whole)
    wrapper = textwrap.TextWrapper(100, break_long_words=False, break_on_hyphens=False)
    for k, block in enumerate(parts[::2]):
        wrapper.subsequent_indent = "  " * block.startswith("- ")
        parts[2 * k] = wrapper.fill(" ".join(block.split()))
    return "".join(parts).replace("\0", " ") + "\n"


def number(x: float) -> str:
    """Return a number with three digits, with an exponent if it is below 0.01 or at least 1,000."""
    if 0.01 <= x < 1000:
        return f"{x:.3g}"
    digits, exponent = f"{x:.2e}".split("e")
    return f"{digits}e{int(exponent)}"


def above(x: float) -> str:
    """Return zero, or a power of ten above a number: the digits of rounding errors mean nothing."""
    return "0" if x == 0.0 else f"< 1e{math.floor(math.log10(x)) + 1}"


def code(name: str) -> str:
    """Return a name as code in Markdown."""
    return f"`{name}`"


def listed(words: Iterable[str]) -> str:
    """Return words as people list them: a, b and c."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
