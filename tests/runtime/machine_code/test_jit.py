"""The machine code of kernels: made of these sources, kept, and made again when it is damaged."""

import ast
import os
import pickle
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from gaussmap.runtime.machine_code import building, disk, entries, jit, linking, signatures, sources
from numba.core import config, event
from numba.core.caching import NullCache

PACKAGE = Path(__file__).parents[3]
# Prints the normal at the centre of a patch of a plane, and how many functions were compiled.
NORMAL = """
import numpy as np
from gaussmap.runtime.spline.kernels.patch import normals_at
from numba.core import config, event

mu = np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0), [0.0], indexing="ij"), axis=-1)[:, :, 0]
normals = np.empty((1, 3))
with event.install_recorder("numba:compile") as compiled:
    normals_at(mu, 0.125, np.array([0]), np.full((1, 2), 1 / 3), normals)
print(*normals[0], len(compiled.buffer) // 2)
"""
FORMULA = "N_z = p_u_x * p_v_y - p_u_y * p_v_x"


def normal_of_copy(folder: Path) -> tuple[list[float], int]:
    """Return a normal that the package in a folder computes, and how much it compiled."""
    environment = os.environ | {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", NORMAL],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    *normal, compiled = done.stdout.split()
    return [float(x) for x in normal], int(compiled)


@pytest.mark.slow
def test_a_changed_formula_is_compiled_again(tmp_path: Path) -> None:
    package = tmp_path / "gaussmap"
    for name in ("generated", "runtime"):  # no tools
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(PACKAGE / name, package / name, ignore=ignored)
    for path in PACKAGE.glob("__init__.py*"):
        shutil.copy(path, package)
    normal, compiled = normal_of_copy(tmp_path)
    assert normal[:2] == [0.0, 0.0]
    assert normal[2] != 0.0
    assert compiled > 0
    assert normal_of_copy(tmp_path) == (normal, 0)

    formulas = package / "generated" / "patch.py"
    source = formulas.read_text(encoding="utf-8")
    assert FORMULA in source
    formulas.write_text(source.replace(FORMULA, FORMULA + " + 7.0"), encoding="utf-8")
    changed, compiled = normal_of_copy(tmp_path)
    assert changed == [0.0, 0.0, normal[2] + 7.0]
    assert compiled > 0

    formulas.write_text(source, encoding="utf-8")
    assert normal_of_copy(tmp_path) == (normal, 0)


def triple(x: float) -> float:
    return 3.0 * x


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which machine code is kept during a test."""
    monkeypatch.setattr(disk, "kept_folder", lambda: tmp_path)
    return tmp_path


def compiled_when(kernel: Callable[[float], float]) -> int:
    """Return how many functions are compiled when a kernel that triples is called."""
    with event.install_recorder("numba:compile") as compiled:
        assert kernel(2.0) == 6.0
    return len(compiled.buffer) // 2


class Trap:
    """What runs code when it is read as a pickle."""

    def __reduce__(self) -> tuple[Any, ...]:
        return pytest.fail, ("a pickle was read",)


def one_bit(content: bytes) -> bytes:
    k = 3 * len(content) // 4
    return content[:k] + bytes([content[k] ^ 1]) + content[k + 1 :]


@pytest.mark.parametrize(
    "damage",
    [
        lambda x: b"",
        lambda x: x[: len(x) // 2],
        lambda x: b"garbage" * 100,
        one_bit,
        lambda x: entries.sealed(pickle.dumps(Trap())),
    ],
)
def test_damaged_machine_code_is_compiled_again(
    damage: Callable[[bytes], bytes], folder: Path
) -> None:
    """And pickles are not read."""
    assert compiled_when(jit.jit(triple)) == 1
    assert compiled_when(jit.jit(triple)) == 0
    (path,) = folder.glob("*.kernel")
    path.write_bytes(damage(path.read_bytes()))
    assert compiled_when(jit.jit(triple)) == 1
    assert compiled_when(jit.jit(triple)) == 0


class Pair(NamedTuple):
    first: float
    second: float


def halved(pair: Pair, by: int) -> tuple[Any, ...]:
    return pair.first / by, (pair.second / by, by)


def test_kernels_of_tuples_are_kept(folder: Path) -> None:
    results = []
    for is_compiled in (True, False):
        with event.install_recorder("numba:compile") as events:
            results.append(jit.jit(halved)(Pair(3.0, 5.0), 2))
        assert (len(events.buffer) > 0) == is_compiled
    assert results == [(1.5, (2.5, 2))] * 2


@pytest.mark.parametrize("option", ["NUMBA_OPT", "NUMBA_BOUNDSCHECK"])
def test_other_options_of_numba_are_other_machine_code(
    option: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert compiled_when(jit.jit(triple)) == 1
    with monkeypatch.context() as patch:
        patch.setenv(option, "1")
        assert compiled_when(jit.jit(triple)) == 1
        assert compiled_when(jit.jit(triple)) == 0
    assert compiled_when(jit.jit(triple)) == 0


@pytest.mark.slow
def test_two_processes_compile_a_kernel_once(tmp_path: Path) -> None:
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "GAUSSMAP_KERNELS": "0"}
    both = [
        subprocess.Popen([sys.executable, "-c", NORMAL], env=environment, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    compiled = sorted(int(process.communicate()[0].split()[-1]) for process in both)
    assert compiled[0] == 0
    assert compiled[1] > 0


def test_a_lock_that_is_held_for_too_long_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "LONGEST_WAIT", 0.05)
    first, second = (disk.FileLock(tmp_path / "lock") for _ in range(2))
    first.acquire()
    start = time.monotonic()
    second.acquire()
    assert time.monotonic() - start >= 0.05
    first.release()
    second.acquire()
    second.release()


def test_a_failed_compilation_keeps_no_lock(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "POLL", None)  # waiting raises TypeError
    kernel = jit.jit(triple)
    for _ in range(2):
        with pytest.raises(numba.TypingError):
            kernel(None)  # pyright: ignore[reportArgumentType]


def test_machine_code_that_cannot_be_saved(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError("No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(entries.os, "replace", full)
        assert compiled_when(jit.jit(triple)) == 1
    assert not [*folder.glob("*.kernel")]
    assert [x.suffix for x in folder.iterdir()] == [".lock"]
    assert compiled_when(jit.jit(triple)) == 1


def test_folders_that_were_not_used_for_long_are_removed(tmp_path: Path) -> None:
    ours, recent, old = (tmp_path / ("kernels-" + x * 16) for x in "012")
    others, now = tmp_path / "kernels-of-somebody", time.time()
    for folder, days in ((ours, 90), (recent, 29), (old, 31), (others, 90)):
        folder.mkdir()
        (folder / "code").write_text("")
        used = now - days * 24 * 3600
        os.utime(folder, (used, used))
    disk.remove_unused(ours)
    assert {*tmp_path.iterdir()} == {ours, recent, others}
    assert ours.stat().st_mtime > now - 60
    disk.remove_unused(tmp_path / "missing" / "folder")


def test_the_digest_covers_all_that_kernels_are_made_of() -> None:
    """Whatever their sources import from this package is among the sources of the digest."""
    listed = {path for name in sources.SOURCES for path in sources.PACKAGE.glob(name)}
    imported = set()
    for path in listed:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
                of_names = [base / f"{x.name}.py" for x in node.names]
                imported |= {x if x.exists() else base.with_suffix(".py") for x in of_names}
    others = "runtime/base/compiling.py", "runtime/machine_code/cache.py"  # show, and keep, code
    assert len(imported) > 30
    assert imported - listed == {sources.PACKAGE / x for x in others}


def test_a_cache_that_cannot_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels are compiled all the same, and not kept."""
    nowhere = Path(os.devnull) / "cache"
    monkeypatch.setattr(disk, "PACKAGE", nowhere)
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(nowhere))
    monkeypatch.setattr(disk, "kept_folder", disk.kept_folder.__wrapped__)
    monkeypatch.setattr(disk, "digest", lambda: "0")

    assert disk.kept_folder() is None
    assert jit.jit(triple)(2.0) == 6.0


# --- kernels are linked with parts that are compiled once -----------------------------------------

# Parts that one kernel has for several types, and why.
COPIES = {
    "decide.unit_of": "the limbs of patches and of normals",
    "hits.evaluate_tile": "with curvatures and without, at compile time",
    "hits.write_numbers": "numbers, indices, and columns of tables",
}


@jit.loop
def at(array, k, factor):
    return factor * array[k]


@jit.loop
def total(array, factor):
    result = 0.0
    for k in range(len(array)):
        result += at(array, k, factor)
    return result


def first_and_total(array):
    return at(array, 0, 2) + total(array, 3)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A kernel that is not compiled yet, with two parts."""
    monkeypatch.setattr(disk, "kept_folder", lambda: None)
    return jit.jit(first_and_total)


def library_of(kernel: Any) -> Any:
    """Call a kernel; return its code."""
    assert kernel(np.arange(4.0) + 1.0) == 32.0
    (compiled,) = kernel.overloads.values()
    return compiled.library


def test_numba_has_what_linking_needs(kernel: Any) -> None:
    """If this fails with a new series of Numba, kernels are right, and take twice as long."""
    assert isinstance(library_of(kernel), linking.Kernel)


def test_parts_have_one_copy_for_all_integers(kernel: Any) -> None:
    parts = [part.name.rpartition(".")[2] for part in library_of(kernel).called]
    assert sorted(parts) == ["at", "total"]


def test_parts_are_compiled_for_the_first_kernel_that_calls_them(kernel: Any) -> None:
    library_of(kernel)
    with event.install_recorder("numba:compile") as compiled:
        library_of(jit.jit(first_and_total))
    assert len(compiled.buffer) == 2  # the start and the end of one


def test_without_what_linking_needs(kernel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another series of Numba may lack it: the results are the same."""
    monkeypatch.setattr(linking, "PRIVATE", ("what_no_library_has",))
    assert not isinstance(library_of(kernel), linking.Part)


def test_long_parts_are_called(kernel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """As short ones are inlined: the results are the same."""
    code = {}
    for small in (0, linking.SMALL):
        monkeypatch.setattr(linking, "SMALL", small)
        for part in (at, total):
            part.overloads.clear()  # pyright: ignore[reportFunctionMemberAccess]
        library = library_of(jit.jit(first_and_total))
        code[small] = [f.name for f in library.get_defined_functions() if "total" in f.name]
    assert len(code[0]) > len(code[linking.SMALL])


@pytest.mark.slow
def test_copies_are_listed() -> None:
    """Kernels that are compiled here, one of each family that calls the most parts."""
    copies: set[str] = set()
    names = ("decide.decide_exactly", "hits.fill_samples", "search.search")
    pairs = "proof.kernels.evaluated_pairs.evaluate_pairs"
    for name in [*(f"search.kernels.{x}" for x in names), pairs]:
        full = f"gaussmap.runtime.{name}"
        kernel = jit.jit(building.kernel_named(full).py_func)
        kernel._cache = NullCache()
        kernel.compile(tuple(map(signatures.as_types, signatures.read()[full][0])))
        (compiled,) = kernel.overloads.values()
        copies.update(linking.copies_in(compiled.library))
    assert {name.partition(".kernels.")[2] for name in copies} == {*COPIES}
