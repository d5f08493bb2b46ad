"""The sources that kernels are made of, and their digest."""

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[2]
SOURCES = (
    "generated/*.py",
    "runtime/*/kernels/*.py",
    "tools/*/kernels/*.py",
    "runtime/base/tolerances.py",
    "runtime/machine_code/jit.py",
    "runtime/machine_code/linking.py",
)


@cache
def digest() -> str:
    """Return a digest of all sources that kernels are made of."""
    paths = sorted(path for name in SOURCES for path in PACKAGE.glob(name))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in paths)).hexdigest()[:16]
