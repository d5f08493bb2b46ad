"""Libraries that may be missing."""

import math

from gaussmap.runtime.base.extras import if_installed


def test_a_library_is_loaded_if_it_is_there():
    assert if_installed("math") is math
    assert if_installed("no_such_module") is None
