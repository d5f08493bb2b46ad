"""Archives from anywhere: bombs, headers that lie, pickles, names that lead elsewhere."""

import io
import struct
import zipfile
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.files.numpy_files import read_array

from ...refusals import refused


def npy(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def write(path: Path, **members: bytes) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)


@pytest.fixture(scope="module")
def bomb(tmp_path_factory) -> Path:
    """Return a file of 0.4 MB that unpacks to 0.4 GB; the rest is the same for any size."""
    path = tmp_path_factory.mktemp("bomb") / "bomb.npz"
    size, step = 400 << 20, 1 << 22
    header = npy(np.zeros(1)).replace(b"(1,), }", f"({size // 8},), }}".encode(), 1)[:128]
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("points.npy", "w", force_zip64=True) as file,
    ):
        file.write(header)
        for _ in range(size // step):
            file.write(bytes(step))
    return path


def test_a_bomb_is_refused_before_anything_is_unpacked(bomb, capsys, monkeypatch, main):
    def fail(*_: object, **__: object) -> None:
        raise AssertionError("it is unpacked")

    monkeypatch.setattr(zipfile.ZipFile, "open", fail)
    for read in (gm.read_samples, gm.read_part):
        refused("", read, bomb, error=gm.errors.FileError)
    with pytest.raises(
        gm.errors.FileError, match=r"would unpack to 419 MB, more than 100 times as much"
    ):
        read_array(str(bomb))
    assert main(["sample", str(bomb), "--spacing", "1", "1", "-o", "a.ply"]) == 2
    assert "write it again without compression" in capsys.readouterr().err


def test_a_size_that_lies_is_noticed(bomb, tmp_path):
    data = bytearray(bomb.read_bytes())
    directory = data.rfind(b"PK\x01\x02")
    struct.pack_into("<I", data, directory + 24, 4096)  # the size that the directory tells
    path = tmp_path / "lie.npz"
    path.write_bytes(data)
    refused("", read_array, str(path), error=gm.errors.FileError)


@pytest.mark.parametrize("shape", ["(9999999999999,)", "(99, 99)", "(-1,)"])
def test_shapes_that_lie(tmp_path, shape):
    data = npy(np.arange(4.0))
    text = b"(4,), }" + b" " * (len(shape) - 4)
    whole = npy(np.arange(4.0)).replace(text, f"{shape}, }}".encode(), 1)
    assert len(whole) == len(data)
    write(tmp_path / "a.npz", points=whole)
    refused("", read_array, str(tmp_path / "a.npz"), error=gm.errors.FileError)


def test_what_is_compressed_well_but_small_is_read(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", points=np.zeros((1000, 1000)))
    assert read_array(str(tmp_path / "a.npz")).shape == (1000, 1000)


def test_names_lead_nowhere(tmp_path):
    """Nothing is ever unpacked to a file, whatever the entries are called."""
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    write(inner / "a.npz", **{"../../evil": npy(np.ones(3)), "/etc/evil": npy(np.ones(4))})
    refused("", gm.read_samples, inner / "a.npz", error=gm.errors.FileError)
    assert [x.name for x in tmp_path.rglob("*")] == ["a", "b", "a.npz"]
