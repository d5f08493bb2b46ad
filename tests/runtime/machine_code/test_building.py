"""The list of signatures, and the kernels that are compiled for it without being called."""

import os
import subprocess
import sys
from collections import namedtuple
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gaussmap.runtime.machine_code import building, disk, jit, listing, shipped, signatures
from numba import typeof, types

from ...refusals import refused

Pair = namedtuple("Pair", "first second")


def readonly() -> np.ndarray:
    array = np.zeros((2, 3), dtype=np.int32)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1.0, "float64"),
        (1, "int64"),
        (True, "bool"),
        (np.float32(1), "float32"),
        (np.uint64(1), "uint64"),
        (np.zeros((2, 3)), "float64 2 C"),
        (np.zeros(4, dtype=bool)[::2], "bool 1 A"),
        (np.zeros((2, 3), order="F"), "float64 2 F"),
        (readonly(), "int32 2 C readonly"),
        ((1, 2.0), ["int64", "float64"]),
        ((1.0, 2.0), ["float64", "float64"]),
        (Pair(1, np.zeros(2)), {f"{__name__}.Pair": ["int64", "float64 1 C"]}),
        (Pair(1, 2), {f"{__name__}.Pair": ["int64", "int64"]}),
    ],
)
def test_types_are_read_as_they_were_written(value: Any, expected: Any) -> None:
    kind = typeof(value)
    assert signatures.as_json(kind) == expected
    if __name__ not in str(expected) or _is_importable():
        assert signatures.as_types(expected) == kind


def _is_importable() -> bool:
    try:
        return signatures.named(f"{__name__}.Pair") is Pair
    except ImportError:  # pytest imports tests from their paths
        return False


def test_types_that_no_kernel_takes() -> None:
    refused("in a signature of a kernel", signatures.as_json, types.unicode_type, error=TypeError)


def test_the_list_is_as_it_would_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = signatures.SIGNATURES.read_bytes()
    listing = signatures.read()
    monkeypatch.setattr(signatures, "SIGNATURES", tmp_path / "signatures.json")
    signatures.write(listing)
    assert signatures.SIGNATURES.read_bytes() == content


@pytest.mark.parametrize("name", [*signatures.read()])
def test_all_listed_kernels_are_there(name: str) -> None:
    kernel = building.kernel_named(name)
    assert f"{kernel.py_func.__module__}.{kernel.py_func.__qualname__}" == name
    for kinds in signatures.read()[name]:
        assert len(kinds) == kernel.py_func.__code__.co_argcount
        assert [signatures.as_json(signatures.as_types(x)) for x in kinds] == kinds


@pytest.mark.slow
def test_what_a_file_has_is_not_compiled_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A longer list, and then those of usual calls."""
    first = "gaussmap.runtime.search.kernels.lists.order_few"
    second = "gaussmap.runtime.directions.kernels.unit.are_unit"
    listing = signatures.read()
    for names, entries_of in (((second,), 1), ((first, second), 2)):
        monkeypatch.setattr(signatures, "read", {x: listing[x] for x in names}.copy)
        path = building.build(tmp_path)
        assert path is not None
        assert len(shipped.Pack(path).places) == entries_of
    whole = shipped.Pack(path)
    monkeypatch.setattr(signatures, "usual", lambda: [second])
    capsys.readouterr()
    assert building.build(tmp_path, usual=True) == path
    assert capsys.readouterr().err == ""
    (key,) = shipped.Pack(path).places
    assert key.startswith(second)
    assert shipped.Pack(path).get(key) == whole.get(key)


def test_usual_kernels_are_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names, content = signatures.usual(), signatures.USUAL.read_bytes()
    assert 0 < len(names) < len(signatures.read())
    assert set(names) <= signatures.read().keys()
    monkeypatch.setattr(signatures, "USUAL", tmp_path / "usual.json")
    signatures.write_usual(reversed(names))
    assert signatures.USUAL.read_bytes() == content


USUAL_CALLS = """
import numpy as np
import gaussmap as gm
from gaussmap.benchmarks.cold_start import CALLS, USUAL
from gaussmap.runtime.machine_code import cache, signatures

asked, load = set(), cache.KernelCache.load_overload

def noted(self, *arguments):
    asked.add(f"{self._function.__module__}.{self._function.__qualname__}")
    return load(self, *arguments)

cache.KernelCache.load_overload = noted
calls = [CALLS[x] for x in USUAL if x in CALLS and "all surfaces" not in x]
for call in (*calls, "gm.sample('torus', normals=np.eye(3))"):
    exec(call.replace("10_000", "300"))
print(len(asked) > 50, asked - {*signatures.usual()})
"""


def test_usual_calls_ask_for_usual_kernels_only() -> None:
    """Otherwise they compile where the package was installed: `make kernels`."""
    done = subprocess.run([sys.executable, "-c", USUAL_CALLS], capture_output=True, text=True)
    assert done.stdout == "True set()\n", done.stderr


@pytest.mark.slow
def test_the_bytes_of_a_file_are_those_of_its_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many processes there are, and whichever of them compiles what."""
    names = (
        "gaussmap.runtime.search.kernels.lists.order_few",
        "gaussmap.runtime.directions.kernels.unit.are_unit",
    )
    listed = {name: signatures.read()[name] for name in names}
    monkeypatch.setattr(signatures, "read", listed.copy)
    built = []
    for cores in (1, 2):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        path = building.build(tmp_path / str(cores))
        built.append(path.read_bytes())
    assert built[0] == built[1]


def test_what_the_list_lacks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A kernel that is compiled here is found; after the list is written, it is on the list."""
    name = "gaussmap.runtime.directions.kernels.unit.are_unit"
    (kinds,) = signatures.read()[name]
    monkeypatch.setattr(disk, "kept_folder", lambda: tmp_path)
    monkeypatch.setattr(shipped, "open_pack", lambda: None)
    monkeypatch.setattr(signatures, "SIGNATURES", tmp_path / "signatures.json")
    signatures.write({})
    kernel = jit.jit(building.kernel_named(name).py_func)
    kernel.compile(tuple(map(signatures.as_types, kinds)))
    assert listing.main([str(tmp_path)]) == 1
    assert f"lacks {name}" in capsys.readouterr().err
    assert listing.main(["--write", str(tmp_path)]) == 0
    assert signatures.read() == {name: [kinds]}
    assert listing.main([str(tmp_path)]) == 0
