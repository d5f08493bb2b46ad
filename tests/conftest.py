"""What all tests share: which of them are slow, and how many random examples they try."""

import os

import pytest
from hypothesis import settings

# `make test` tries few random examples, and `make verify` many (--hypothesis-profile=large).
settings.register_profile("quick", max_examples=20, deadline=None)
settings.register_profile("large", max_examples=200, deadline=None)
settings.load_profile("quick")


def pytest_configure(config: pytest.Config) -> None:
    for marker in (
        "compiled: needs compiled kernels (too slow under NUMBA_DISABLE_JIT=1)",
        "slow: takes long and seldom fails; run by `make verify`, and not by `make test`",
    ):
        config.addinivalue_line("markers", marker)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        skip = pytest.mark.skip(reason="too slow without compilation")
        for item in items:
            if item.get_closest_marker("compiled"):
                item.add_marker(skip)
