"""The file of machine code that comes with the package: what it is good for, and when it is not."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.runtime.machine_code import cache, disk, entries, jit, processors, shipped

from .test_jit import compiled_when, triple


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The path of a file that has one kernel, in the folder of a package that knows no other."""
    monkeypatch.delenv(shipped.SWITCH, raising=False)
    monkeypatch.setattr(disk, "kept_folder", lambda: None)
    path = shipped.pack_path(tmp_path)
    assert path is not None
    monkeypatch.setattr(shipped, "pack_path", lambda: path)
    entry: list[bytes] = []
    forget()
    kernel: Any = jit.jit(triple)
    monkeypatch.setattr(
        kernel._cache, "save_overload", lambda _, x: entry.append(entries.entry_of(x))
    )
    assert compiled_when(kernel) == 1
    (signature,) = kernel.signatures
    shipped.write_pack(path, {entries.key_of(triple, signature): entry[0]})
    forget()
    yield path
    forget()


def forget() -> None:
    """Forget what is remembered for a whole process."""
    for function in (shipped.open_pack, cache.say_why):
        function.cache_clear()


def test_nothing_is_compiled(package: Path) -> None:
    kernel: Any = jit.jit(triple)
    assert compiled_when(kernel) == 0
    assert kernel(1.0) == 3.0
    assert kernel(2) == 6  # another type, which is compiled here
    assert len(kernel.signatures) == 2


def at(place: int, content: bytes) -> bytes:
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


def rewritten(path: Path, **changes: object) -> None:
    """Change the header of a file."""
    pack = shipped.Pack(path)
    contents = {key: pack.get(key) or b"" for key in pack.places}
    shipped.write_pack(path, contents, **(pack.header | changes))


DAMAGES: list[Callable[[bytes], bytes]] = [
    lambda x: b"",
    lambda x: b"garbage" * 100,
    lambda x: x[: len(shipped.MAGIC)],
    lambda x: x[: len(x) // 2],
    lambda x: x[:-1],
    lambda x: at(3, x),  # in the name of the format
    lambda x: at(len(shipped.MAGIC) + shipped.WORD - 1, x),  # in the size of the header
    lambda x: at(len(shipped.MAGIC) + shipped.WORD, x),  # in its checksum
    lambda x: at(len(shipped.MAGIC) + shipped.WORD + 40, x),  # in the header
    lambda x: at(len(x) - 5, x),  # in an entry
    lambda x: x.replace(b'"places"', b'"palaces"'),
    lambda x: x.replace(b'"identity"', b'"identify"'),
    lambda x: x.replace(b'"digest"', b'"digits"'),
]
LEVEL = processors.level_here()
OTHER = LEVEL._replace(features=f"{LEVEL.features} telepathy")
# What happens to the file, or to the process.
REASONS: dict[str, Callable[[Path, pytest.MonkeyPatch], object]] = {
    "the file is missing": lambda path, patch: path.unlink(),
    "it is of other sources": lambda path, patch: rewritten(path, digest="0" * 16),
    "the processor lacks a feature": lambda path, patch: patch.setattr(
        shipped, "level_here", lambda: OTHER
    ),
    "it is switched off": lambda path, patch: patch.setenv("GAUSSMAP_KERNELS", "0"),
    "options of Numba are others": lambda path, patch: patch.setenv("NUMBA_OPT", "1"),
    **{
        f"the file is damaged ({k})": lambda path, patch, damage=damage: path.write_bytes(
            damage(path.read_bytes())
        )
        for k, damage in enumerate(DAMAGES)
    },
}


@pytest.mark.parametrize("reason", REASONS)
def test_the_file_is_not_used_without_a_warning(
    reason: str, package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    REASONS[reason](package, monkeypatch)
    assert compiled_when(jit.jit(triple)) == 1


@pytest.mark.parametrize("name", ["numba", "llvmlite", "python", "platform"])
def test_other_versions_are_named(name: str, package: Path) -> None:
    rewritten(package, identity=processors.identity() | {name: "0.1"})
    with pytest.warns(
        gm.errors.GaussmapWarning, match=rf"are for {name} 0\.1: new ones are compiled"
    ):
        assert compiled_when(jit.jit(triple)) == 1
    assert compiled_when(jit.jit(triple)) == 1  # it is said once


def test_a_file_that_cannot_be_written_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "x.kernels"
    shipped.write_pack(path, {"a": b"first"})

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(entries.os, "replace", stop)
    with pytest.raises(KeyboardInterrupt):
        shipped.write_pack(path, {"a": b"second"})
    assert shipped.Pack(path).get("a") == b"first"
    assert shipped.Pack(path).get("b") is None
    assert [*tmp_path.iterdir()] == [path]


# --- modules that `import gaussmap` and a first call load -----------------------------------------

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
