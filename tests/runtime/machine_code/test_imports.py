"""What `import gaussmap` and a first call load: nothing large that they do not need."""

import subprocess
import sys

import pytest

# Numba loads the last two, and parts of SciPy, with its compiler.
LARGE = (
    "contourpy", "matplotlib", "pandas", "pyarrow", "scipy.linalg", "scipy.spatial",
    "scipy.ndimage", "scipy.stats", "sympy", "pyvista", "tqdm",
    "numba.np.arraymath", "numba.np.linalg",
)  # fmt: skip
EXPECTED = {"numba", "numpy"}


def loaded_by(code: str) -> set[str]:
    """Return the large modules that a new process has loaded after some code."""
    listing = f"import sys; print(*[x for x in {(*LARGE, *EXPECTED)} if x in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{listing}"], capture_output=True, text=True, check=True
    )
    return set(done.stdout.splitlines()[-1].split()) if done.stdout.strip() else set()


def test_the_import_loads_nothing() -> None:
    assert loaded_by("import gaussmap") == set()


@pytest.mark.parametrize(
    ("calls", "others"),
    [
        (
            "gm.sample('torus', 500); gm.sample('torus', normals=gm.fibonacci(50));"
            " gm.sample('torus', 500, density='uniform')",
            {"scipy.linalg", "scipy.spatial"},  # for sizes of neighbouring cells
        ),
        ("gm.sample('torus', angle=20).mesh()", {"scipy.linalg", "scipy.spatial"}),
        ("gm.sample('torus', normals=gm.fibonacci(50))", set()),
    ],
)
def test_a_first_call_loads_numba_without_its_compiler(calls: str, others: set[str]) -> None:
    """Machine code of the package, or kept, is there: its types are known without compiling."""
    from gaussmap.runtime.machine_code import shipped

    if shipped.open_pack() is None:
        pytest.skip("there is no machine code of these sources: make compiled")
    assert loaded_by(f"import gaussmap as gm; {calls}") == EXPECTED | others
