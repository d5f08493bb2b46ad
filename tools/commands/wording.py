"""Messages of the library in the words of the command line: options instead of arguments."""

from __future__ import annotations

import re

__all__ = ["for_commands"]

# The arguments of Python functions that are options of commands.
OPTIONS = (
    "count|angle|coverage|normals|density|reach|cells|on|fields|threads|edges|spacing|periodic|"
    "nodata|tolerance|band|x|y|crs|source_crs|origin|unit|time_limit|memory_limit|seed|prefer|"
    "workers|files|compression|measure|scheduler|overwrite|retry_failed|domain"
)
# Not in names of files, which are in quotes.
OUTSIDE = r"(?<![\w'\"/\\])"
VALUE = r"\"[^\"]*\"|'[^']*'|\.\.\.|…|\([^)]*\)|[-+\w.]*\w"
ARGUMENT = re.compile(rf"{OUTSIDE}({OPTIONS})=({VALUE})")
PRECISION = {
    r"\bdtype=(\"float32\"|numpy\.float32)": "--float32",
    r"\bdtype=numpy\.float64": "double precision",
}
# A function, a method or an attribute of Python.
NAME = (
    rf"{OUTSIDE}(?:(?:gm|numpy|Samples|Surface|Spline|Part)\.[a-z]\w*|"
    r"samples\.(?:progressive|mesh|plot)|"
    r"part\.(?:failed|faces|save|select)|surface\.(?:pieces|trims))\b"
)
# What says how it is done in Python: in parentheses, or after a comma or a semicolon.
INSIDE = r"(?:[^()]|\([^()]*\))*"
ASIDE = re.compile(rf"\s*\({INSIDE}{NAME}{INSIDE}\)")
CLAUSE = re.compile(rf"[;,](?:[^;,.()]|\.(?=\w)|\([^()]*\))*?{NAME}(?:[^;.]|\.(?=[\w(.]))*")


def for_commands(message: str) -> str:
    """Return a message with options in place of arguments, without the names of functions."""
    for python, words in PRECISION.items():
        message = re.sub(python, words, message)
    message = CLAUSE.sub("", ASIDE.sub("", message))
    return ARGUMENT.sub(_option, message)


def _option(found: re.Match[str]) -> str:
    name, value = f"--{found[1].replace('_', '-')}", found[2].strip("\"'")
    return name if value in ("...", "…", "True") or value[:1] == "(" else f"{name} {value}"
