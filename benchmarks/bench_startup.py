"""The start of the command line, with kernels that are compiled."""

from __future__ import annotations

import pytest

# The first call of any compiled function makes Numba load itself: a lower limit for sampling.
ONE_KERNEL = "import numba\n@numba.njit(cache=True)\ndef f(x):\n    return x\nf(1.0)\n"
COMMANDS = {
    "surfaces": ["surfaces"],
    "sample-torus": ["sample", "torus", "--count", "1000", "-o", "x.npz"],
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=list(COMMANDS))
def test_start(compare, run, warm_cache, tmp_path, command):
    one_kernel = tmp_path / "one_kernel.py"
    one_kernel.write_text(ONE_KERNEL, encoding="utf-8")
    compare(
        run(*command, script="gaussmap", cache=warm_cache),
        baselines={
            "import_numba_and_numpy": run("-c", "import numba, numpy"),
            "one_cached_kernel": run(str(one_kernel), cache=warm_cache),
        },
        rounds=3,
    )
