import os

import pytest


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers", "compiled: needs compiled kernels (too slow under NUMBA_DISABLE_JIT=1)"
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        skip = pytest.mark.skip(reason="too slow without compilation")
        for item in items:
            if item.get_closest_marker("compiled"):
                item.add_marker(skip)
