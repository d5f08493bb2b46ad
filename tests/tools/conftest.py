"""What tests of the tools share."""

from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def parts() -> ModuleType:
    """Functions that return CAD parts made of numbers: no public one does without a file."""
    from gaussmap.tools.cad import examples

    return examples
