"""The first half second: Ctrl-C, and who tells that kernels are compiled."""

import os
import subprocess
import sys
from pathlib import Path

import gaussmap as gm
import pytest

posix = pytest.mark.skipif(os.name != "posix", reason="needs signals")

# Runs the command, and presses Ctrl-C when a module is first imported.
INTERRUPTED = """
import os, signal, sys

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "{module}":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Finder())
sys.argv = ["gaussmap", "surfaces", "torus"]
{before}
from gaussmap.__main__ import main
sys.exit(main())
"""


def run(code: str) -> tuple[int, str, str]:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


@posix
@pytest.mark.parametrize("module", ["gaussmap.runtime", "numpy", "llvmlite", "numba.core.types"])
def test_interrupted_while_importing(module: str) -> None:
    # A test run in the background ignores interrupts, and what it starts would do so too.
    before = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    code = INTERRUPTED.format(module=module, before=before)
    assert run(code) == (130, "", "gaussmap: interrupted\n")


@posix
def test_who_ignores_interrupts_goes_on_doing_so() -> None:
    code = INTERRUPTED.format(module="numba", before="signal.signal(signal.SIGINT, signal.SIG_IGN)")
    status, out, err = run(code)
    assert (status, err) == (0, "")
    assert out.startswith("torus")


@posix
def test_interrupted_when_all_is_done() -> None:
    code = (
        "import os, signal, sys, weakref\n"
        "from gaussmap.__main__ import main\n"
        "sys.argv = ['gaussmap', 'surfaces', 'torus']\n"
        "class At: pass\n"
        "at = At()\n"
        "weakref.finalize(at, lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "sys.exit(main())"
    )
    status, out, err = run(code)
    assert (status, err) == (0, "")
    assert out.startswith("torus")


# One public name of each module.
PUBLIC = {
    getattr(getattr(gm, name), "__module__", name): name for name in dir(gm) if name != "symbolic"
}.values()


@pytest.mark.slow
def test_who_compiles_tells(tmp_path: Path) -> None:
    """Whichever name is used first, the notice is there if kernels are."""
    code = (
        "import os, sys, numba, scipy.spatial, scipy.special, gaussmap as gm\n"  # once, not in each
        "sys.pycache_prefix, sys.dont_write_bytecode = sys.argv.pop(1), False\n"
        "for name in sys.argv[1:]:\n"
        "    if os.fork():\n"
        "        assert os.wait()[1] == 0\n"
        "        continue\n"
        "    getattr(gm, name)\n"
        "    ours = [x for x in sys.modules if x.startswith('gaussmap.')]\n"
        "    kernels = [x for x in ours if '.kernels.' in x or '.generated.' in x]\n"
        "    print(name, len(kernels), 'gaussmap.runtime.base.compiling' in sys.modules)\n"
        "    sys.exit()"
    )
    if not hasattr(os, "fork"):
        pytest.skip("needs fork")
    command = [sys.executable, "-c", code, str(tmp_path), *PUBLIC]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    rows = [line.split() for line in done.stdout.splitlines()]
    assert {row[0] for row in rows} == {*PUBLIC}
    assert [row for row in rows if row[1] != "0" and row[2] != "True"] == []
    assert sum(row[1] != "0" for row in rows) > 10
