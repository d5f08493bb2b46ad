"""`read_cad`: the process that reads, its limits, and what it says."""

# pyright: reportMissingImports=false

import os
import sys
import time

import numpy as np
import pytest
from gaussmap.runtime.cad import reader
from gaussmap.runtime.cad.reader import read_cad
from gaussmap.runtime.errors import FileError, GaussmapWarning, InputError, MissingExtraError

with_ocp = pytest.mark.skipif(
    "not __import__('importlib.util').util.find_spec('OCP')", reason="needs Open CASCADE"
)


@pytest.fixture
def installed(monkeypatch):
    """Let Open CASCADE seem to be there: these files are refused before it is loaded."""
    monkeypatch.setattr(reader, "check_extra", lambda *_: None)


@pytest.mark.parametrize(
    ("content", "reason"),
    [(b"", "is empty."), (b"hello\n" * 9, "is not a STEP, IGES or BREP file.")],
)
def test_bad_files_are_refused_in_a_sentence(content, reason, tmp_path, installed):
    path = tmp_path / "part.step"
    path.write_bytes(content)
    with pytest.raises(FileError) as error:
        read_cad(path)
    assert str(error.value) == f"'{path}' {reason}"


def test_paths_that_are_no_files_are_refused(tmp_path):
    with pytest.raises(FileError, match="is a folder"):
        read_cad(tmp_path)
    with pytest.raises(FileError, match="does not exist"):
        read_cad(tmp_path / "part.step")
    os.mkfifo(tmp_path / "pipe.step")
    with pytest.raises(FileError, match="is no file"):
        read_cad(tmp_path / "pipe.step")


@pytest.mark.parametrize(
    "arguments",
    [
        {"unit": "ell"},
        {"unit": 3},
        {"time_limit": 0},
        {"time_limit": float("nan")},
        {"memory_limit": -1},
        {"memory_limit": 0.5},
        {"memory_limit": "much"},
    ],
)
def test_arguments_are_checked(arguments, tmp_path):
    with pytest.raises(InputError, match=next(iter(arguments))):
        read_cad(tmp_path / "part.step", **arguments)


def test_without_open_cascade_the_extra_is_named(tmp_path, monkeypatch):
    path = tmp_path / "part.step"
    path.write_bytes(b"ISO-10303-21;")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"gaussmap\[cad\]"):
        read_cad(path)


def sleeping(code: str) -> list[str]:
    return [sys.executable, "-c", code]


def test_a_process_that_hangs_is_gone_after_the_limit(tmp_path, installed, monkeypatch):
    path, alive = tmp_path / "part.step", tmp_path / "alive"
    path.write_bytes(b"ISO-10303-21;")
    # A process with a child of its own, which both would write to a file in a while.
    write = f"import time; time.sleep(1.5); open({str(alive)!r}, 'w')"
    code = f"import os, sys; os.fork(); {write}"
    monkeypatch.setattr(reader, "_command", lambda request: sleeping(code))
    start = time.perf_counter()
    with pytest.raises(FileError, match=r"was not read within 0\.5 s"):
        read_cad(path, time_limit=0.5)
    assert time.perf_counter() - start < 2.5
    time.sleep(1.5)
    assert not alive.exists()


def test_a_process_that_crashes_is_an_error(tmp_path, installed, monkeypatch):
    path = tmp_path / "part.step"
    path.write_bytes(b"ISO-10303-21;")
    code = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    monkeypatch.setattr(reader, "_command", lambda request: sleeping(code))
    with pytest.raises(FileError, match=r"crash \(SIGSEGV\)"):
        read_cad(path)


# --- with Open CASCADE ----------------------------------------------------------------------------


def write_box(path, unit="INCH"):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    shape = BRepPrimAPI_MakeBox(50.8, 25.4, 76.2).Shape()
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")


@with_ocp
def test_a_part_is_read(tmp_path, capfd):
    path = tmp_path / "box.step"
    write_box(path)
    capfd.readouterr()
    part = read_cad(path)
    assert capfd.readouterr() == ("", "")
    assert (part.name, part.unit, part.oriented, len(part.solids)) == ("box.step", "in", True, 1)
    assert [x.kind for x in part.faces] == 6 * ["plane"]
    assert part.area == pytest.approx(22.0)
    part.save(tmp_path / "box.npz")
    again = reader.read_part(tmp_path / "box.npz")
    for name, array in part.arrays.items():
        np.testing.assert_array_equal(array, again.arrays[name])


@with_ocp
def test_failed_faces_are_a_warning(tmp_path, capfd):
    path = tmp_path / "bö\udcffx.step"  # a name that is not UTF-8
    plain = tmp_path / "box.step"
    write_box(plain)
    plain.rename(path)
    text = path.read_text()
    path.write_text(text.replace("ADVANCED_FACE('',(#", "ADVANCED_FACE('lid',(#99999", 1))
    with pytest.warns(GaussmapWarning, match=r"1 of 6 faces of .* cannot be used: face 5 \(lid\)"):
        part = read_cad(path, unit="mm")
    assert [x.name for x in part.failed] == ["lid"]
    assert part.unit == "mm"


@with_ocp
def test_a_file_that_takes_too_long_is_an_error(tmp_path):
    path = tmp_path / "box.step"
    write_box(path)
    start = time.perf_counter()
    with pytest.raises(FileError, match=r"was not read within 0\.1 s"):
        read_cad(path, time_limit=0.1)
    assert time.perf_counter() - start < 2.1
