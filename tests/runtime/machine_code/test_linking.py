"""Kernels are linked with parts that are compiled once, by what Numba has inside."""

from typing import Any

import numpy as np
import pytest
from gaussmap.runtime.machine_code import building, disk, jit, linking, signatures
from numba.core import event
from numba.core.caching import NullCache

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
