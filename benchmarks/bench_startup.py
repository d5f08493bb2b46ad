"""The first run, which compiles, and the start of the command line after it."""

from __future__ import annotations

import pytest

SAMPLE = "import gaussmap as gm; gm.sample(gm.surfaces.torus(), count=1000, density='gauss')"
# The first call of any compiled function makes Numba load itself: a lower limit for sampling.
ONE_KERNEL = "import numba\n@numba.njit(cache=True)\ndef f(x):\n    return x\nf(1.0)\n"
COMMANDS = {
    "surfaces": ["surfaces"],
    "sample-torus": ["sample", "torus", "--count", "1000", "-o", "x.npz"],
}


def test_first_compile(compare, run, tmp_path_factory, warm_cache):
    def compile_all():
        run("-c", SAMPLE, cache=tmp_path_factory.mktemp("numba"))()

    with_cache = run("-c", SAMPLE, cache=warm_cache)
    with_cache()
    compare(compile_all, baselines={"the_same_from_cache": with_cache}, rounds=1, warm=False)


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
        rounds=7,
    )
