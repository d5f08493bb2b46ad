"""What stands in pages in Markdown."""

import re


def tables(page: str) -> list[list[list[str]]]:
    """Return the tables of a page: rows of cells, without the line of dashes."""
    blocks = re.findall(r"(?:^\|.*\n)+", page, re.MULTILINE)
    rows = [[line.strip("|").split(" | ") for line in block.splitlines()] for block in blocks]
    return [[[x.strip(" `") for x in row] for row in (block[0], *block[2:])] for block in rows]
