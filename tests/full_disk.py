"""The closest to a full disk that needs no real one."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def tiny_disk(most: int = 500) -> Iterator[None]:
    """No file can grow beyond some bytes.

    Keep it round the one call that must fail: pytest's own log is a file too.
    """
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
