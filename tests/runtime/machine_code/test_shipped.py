"""The file of machine code that comes with the package: what it is good for, and when it is not."""

import json
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.runtime.machine_code import cache, disk, entries, jit, processors, shipped, sources
from numba.core import event


def triple(x: float) -> float:
    return 3.0 * x


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
    assert compiled_by(kernel) == 1
    (signature,) = kernel.signatures
    shipped.write_pack(path, {entries.key_of(triple, signature): entry[0]})
    forget()
    yield path
    forget()


def forget() -> None:
    """Forget what is remembered for a whole process."""
    for function in (shipped.open_pack, cache.say_why):
        function.cache_clear()


def compiled_by(kernel: Callable[[float], float]) -> int:
    with event.install_recorder("numba:compile") as compiled:
        assert kernel(2.0) == 6.0
    return len(compiled.buffer) // 2


def test_nothing_is_compiled(package: Path) -> None:
    kernel: Any = jit.jit(triple)
    assert compiled_by(kernel) == 0
    assert kernel(1.0) == 3.0
    assert kernel(2) == 6  # another type, which is compiled here
    assert len(kernel.signatures) == 2


def at(place: int, content: bytes) -> bytes:
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


@pytest.mark.parametrize(
    "damage",
    [
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
    ],
)
def test_a_damaged_file_is_ignored(damage: Callable[[bytes], bytes], package: Path) -> None:
    package.write_bytes(damage(package.read_bytes()))
    assert compiled_by(jit.jit(triple)) == 1


def test_a_missing_file_is_none(package: Path) -> None:
    package.unlink()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compiled_by(jit.jit(triple)) == 1


def rewritten(path: Path, **changes: object) -> None:
    """Change the header of a file."""
    pack = shipped.Pack(path)
    contents = {key: pack.get(key) or b"" for key in pack.places}
    shipped.write_pack(path, contents, **(pack.header | changes))


def test_kernels_of_other_sources_are_compiled(package: Path) -> None:
    rewritten(package, digest="0" * 16)
    assert json.dumps(sources.digest()) != '"0000000000000000"'
    assert compiled_by(jit.jit(triple)) == 1


@pytest.mark.parametrize("name", ["numba", "llvmlite", "python", "platform"])
def test_other_versions_are_named(name: str, package: Path) -> None:
    rewritten(package, identity=processors.identity() | {name: "0.1"})
    with pytest.warns(
        gm.errors.GaussmapWarning, match=rf"are for {name} 0\.1: new ones are compiled"
    ):
        assert compiled_by(jit.jit(triple)) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compiled_by(jit.jit(triple)) == 1  # it is said once


def test_a_processor_that_lacks_a_feature(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    level = processors.level_here()
    monkeypatch.setattr(
        shipped, "level_here", lambda: level._replace(features=f"{level.features} telepathy")
    )
    assert compiled_by(jit.jit(triple)) == 1


@pytest.mark.parametrize(("variable", "value"), [("GAUSSMAP_KERNELS", "0"), ("NUMBA_OPT", "1")])
def test_it_can_be_switched_off(
    variable: str, value: str, package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(variable, value)
    assert compiled_by(jit.jit(triple)) == 1


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
