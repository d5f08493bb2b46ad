"""Files of samples: whole and exact, or refused in one sentence, whatever happens to them."""

import errno
import json
import os
import pickle
import re
import stat
import sys
import tempfile
import zipfile
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pyarrow
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.files import formats
from gaussmap.tools.files.formats import READABLE_SUFFIXES, SUFFIXES, read_samples, write_samples
from gaussmap.tools.files.paths import atomic_path, check_target

from ...full_disk import tiny_disk
from ...refusals import refused
from ...shapes import FIELDS, same
from .made import columns_of, make, ply_by_trimesh

COLUMNS = list(columns_of(make(0)))
# Labels that a careless format would break: line ends, quotes, other alphabets, trailing spaces.
LABEL = ' x²\r\n"y" <&> \\ \u2028 \U0001f369 ' + 300 * " " + "end_header\ncomment "

every_suffix = pytest.mark.parametrize("suffix", SUFFIXES)
every_readable = pytest.mark.parametrize("suffix", READABLE_SUFFIXES)
posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX permissions and links")


def assert_same(samples: gm.Samples, other: gm.Samples) -> None:
    """Equal bit for bit, report included."""
    same(samples, other)
    assert other.report == samples.report
    for name in samples.fields:
        array = getattr(other, name)
        assert array.shape == getattr(samples, name).shape
        assert array.flags.c_contiguous
        assert array.flags.writeable


def assert_bits(actual: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_array_equal(actual, expected)
    np.testing.assert_array_equal(np.signbit(actual), np.signbit(expected))


def unread(path: Any, message: str = "", kind: type[Exception] = gm.errors.FileError) -> str:
    """Check that a file is not read, and return the one sentence that says why."""
    return refused(message, read_samples, path, error=kind)


def check(path: Any) -> None:
    check_target(path, SUFFIXES)


def litter(folder: Path, *expected: str) -> list[str]:
    return sorted(set(os.listdir(folder)) - set(expected))


# --- what is written is read ----------------------------------------------------------------------

ON_SURFACE = replace(
    make().report, on="surface", unrefined=4, fit_distance=1e-5, fit_rms=6e-6, fit_angle=0.03
)
SAMPLES: dict[str, gm.Samples] = {
    **{f"{count}": make(count) for count in (0, 1, 2, 12, 4095, 4096, 4097, 12289)},
    "any label": make(label=LABEL),
    "unknown numbers": make(report=SamplingReport("s", None, 12, None, None, None)),
    "on the surface": make(on_surface=np.arange(12) % 3 > 0, report=ON_SURFACE),
    "a part": make()[3:5],
    "largest indices": make(2, normal_index=np.array([-(2**31), 2**31 - 1])),
}


@every_readable
@pytest.mark.parametrize("samples", SAMPLES.values(), ids=SAMPLES)
def test_bit_for_bit(tmp_path, suffix, samples):
    samples.write(tmp_path / f"file{suffix}")
    assert_same(samples, read_samples(tmp_path / f"file{suffix}"))


@pytest.mark.parametrize("name", ["normal_index", "patch_index"])
@pytest.mark.parametrize("value", [2**31, -(2**31) - 1, 2**32])
def test_indices_too_large_for_ply(tmp_path, name, value):
    changes: dict[str, Any] = {name: np.array([0, value])}
    samples = make(2, **changes)
    message = rf"^{name} goes up to {abs(value):,}, but a \.ply"
    refused(message, write_samples, samples, tmp_path / "file.ply")
    assert litter(tmp_path) == []
    write_samples(samples, tmp_path / "file.npz")
    assert_same(samples, read_samples(tmp_path / "file.npz"))


@every_suffix
def test_equal_samples_make_equal_files(tmp_path, suffix, monkeypatch):
    """Later, in capitals, by a relative path, of read-only arrays, over an older file.

    No other library is needed, but VTK for its own files.
    """
    pyarrow.array(np.zeros(1))  # now pyarrow looks for pandas, and only once
    others = (
        "trimesh",
        "meshio",
        "pandas",
        *(["pyvista", "vtkmodules"] if suffix != ".vtp" else []),
    )
    for library in others:
        monkeypatch.setitem(sys.modules, library, None)
    monkeypatch.chdir(tmp_path)
    samples, names = make(), ["one", "a b.c", "CAPS", "old"]
    names = [f"{x}{suffix.upper() if x == 'CAPS' else suffix}" for x in names]
    write_samples(samples, tmp_path / names[0])
    monkeypatch.setattr("time.time", lambda: 2.0e9)
    for name in FIELDS:
        getattr(samples, name).setflags(write=False)
    Path(names[3]).write_text("old")
    for name in names[1:]:
        write_samples(samples, name)
    assert litter(tmp_path) == sorted(names)
    assert len({Path(x).read_bytes() for x in names}) == 1
    assert Path(names[0]).stat().st_size > 500
    if suffix in READABLE_SUFFIXES:
        assert_same(make(), read_samples(names[2]))


# --- what other programs find in the files --------------------------------------------------------


@pytest.mark.parametrize("count", [0, 1, 12, pytest.param(5000, marks=pytest.mark.slow)])
def test_csv_and_xyz(tmp_path, count):
    samples = make(count)
    write_samples(samples, tmp_path / "file.csv")
    lines = (tmp_path / "file.csv").read_bytes().decode("ascii").splitlines()
    assert lines[0] == ",".join(COLUMNS)
    table = np.array([line.split(",") for line in lines[1:]], float).reshape(count, 13)
    for name, column in columns_of(samples).items():
        assert_bits(table[:, COLUMNS.index(name)], column)
    assert all(re.fullmatch(r"\d+,\d+", ",".join(line.split(",")[11:])) for line in lines[1:])
    write_samples(samples, tmp_path / "file.xyz")
    rows = [line.split() for line in (tmp_path / "file.xyz").read_text().splitlines()]
    assert_bits(np.array(rows, float).reshape(count, 6), table[:, :6])


def test_npz_with_numpy(tmp_path):
    samples = make()
    write_samples(samples, tmp_path / "file.npz")
    with np.load(tmp_path / "file.npz", allow_pickle=False) as archive:
        assert set(archive) == {*FIELDS, "report", "format_version"}
        assert archive["format_version"] == 1
        assert json.loads(str(archive["report"])) == asdict(samples.report)
        for name in FIELDS:
            assert_bits(archive[name], getattr(samples, name))


@pytest.mark.parametrize("count", [0, 12])
def test_ply_with_trimesh(tmp_path, count):
    write_samples(make(count), tmp_path / "file.ply")
    vertices = ply_by_trimesh(tmp_path / "file.ply")["vertex"]["data"]
    assert vertices.shape == (count,)
    assert list(vertices.dtype.names or ()) == COLUMNS
    for name, column in columns_of(make(count)).items():
        assert_bits(vertices[name], column)


def test_ply_header(tmp_path):
    write_samples(make(), tmp_path / "file.ply")
    header, body = (tmp_path / "file.ply").read_bytes().split(b"end_header\n", 1)
    lines = header.decode("ascii").splitlines()
    assert lines[:2] == ["ply", f"format binary_{sys.byteorder}_endian 1.0"]
    assert lines[2] == "comment written by gaussmap"
    types = zip(["double"] * 11 + ["int"] * 2, COLUMNS, strict=True)
    assert [line for line in lines[2:] if not line.startswith("comment ")] == [
        "element vertex 12", *(f"property {kind} {name}" for kind, name in types)
    ]  # fmt: skip
    assert len(body) == 12 * (11 * 8 + 2 * 4)
    write_samples(make(label=LABEL * 9), tmp_path / "file.ply")
    header = (tmp_path / "file.ply").read_bytes().split(b"\nend_header\n", 1)[0]
    assert len(header) > 3000
    assert max(len(line) for line in header.split(b"\n")) < 255


@pytest.mark.parametrize("count", [0, 1, 12])
def test_vtp_with_pyvista(tmp_path, count):
    pv = pytest.importorskip("pyvista")
    samples = make(count, label=LABEL)
    write_samples(samples, tmp_path / "file.vtp")
    cloud = pv.read(tmp_path / "file.vtp")
    assert (cloud.n_points, cloud.n_verts) == (count, count)
    assert cloud.point_data.active_normals_name == "normals"
    assert_bits(np.asarray(cloud.points).reshape(-1, 3), samples.points)
    assert set(cloud.point_data.keys()) == set(FIELDS) - {"points"}
    for name in set(FIELDS) - {"points"}:
        array = np.asarray(cloud.point_data[name])
        assert array.dtype == getattr(samples, name).dtype
        assert_bits(array, getattr(samples, name))
    assert json.loads(cloud.field_data["report"][0]) == asdict(samples.report)


# --- .ply files that another program rewrote ------------------------------------------------------


def rewrite(path: Path, faces: bytes = b"", **columns: np.ndarray) -> gm.Samples:
    """Write samples as others do, with some columns changed, and read them."""
    data = columns_of(make()) | columns
    rows = np.empty(12, [(name, column.dtype) for name, column in data.items()])
    for name, column in data.items():
        rows[name] = column
    header = [f"format binary_{sys.byteorder}_endian 1.0", "comment by another program"]
    header += ["obj_info and more of it", "element vertex 12"]
    header += [f"property {column.dtype} {name}" for name, column in data.items()]
    if faces:
        header += ["element face 4", "property list uint8 int32 vertex_indices"]
    path.write_bytes("\n".join(["ply", *header, "end_header\n"]).encode() + rows.tobytes() + faces)
    return read_samples(path)


def test_what_another_program_wrote(tmp_path):
    """The report is unknown then; more columns, single precision, and faces may be there."""
    path, samples = tmp_path / "file.ply", make()
    other = rewrite(path)
    assert other.report == SamplingReport("an unknown surface", None, 12, None, None, None)
    assert_same(replace(samples, report=other.report), other)
    assert other.summary().startswith("12 samples (")
    assert repr(other).startswith("Samples(12 points on an unknown surface: ")
    assert_bits(rewrite(path, red=np.ones(12, np.uint8)).support, samples.support)
    assert_bits(rewrite(path, faces=4 * (b"\3" + bytes(12))).points, samples.points)
    with np.errstate(all="ignore"):
        single = samples.support.astype(np.float32)
    assert_bits(rewrite(path, support=single).support, single.astype(float))
    for name, kind in (("normal_index", "float64"), ("patch_index", "uint64")):
        with pytest.raises(gm.errors.FileError, match=f"has {kind} numbers as {name}"):
            rewrite(path, b"", **{name: np.ones(12, kind)})


@pytest.fixture
def content(tmp_path) -> bytes:
    """What is in a .ply file of samples."""
    write_samples(make(), tmp_path / "file.ply")
    return (tmp_path / "file.ply").read_bytes()


def test_the_other_byte_order_of_ply(tmp_path, content):
    header, body = content.split(b"end_header\n", 1)
    row = np.dtype([("f", "f8", 11), ("i", "i4", 2)])
    here, there = (b"little", b"big") if b"little" in header else (b"big", b"little")
    header, body = header.replace(here, there), np.frombuffer(body, row).byteswap().tobytes()
    (tmp_path / "file.ply").write_bytes(header + b"end_header\n" + body)
    assert_same(make(), read_samples(tmp_path / "file.ply"))


VERTICES, X = b"element vertex 12", b"property double x"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (VERTICES, b"element vertex 11", r"has [\d,]+ bytes instead of [\d,]+; write it again"),
        (VERTICES, b"element vertex 13", "ends early; write it again"),
        (VERTICES, b"element vertex -1", ""),
        (VERTICES, b"element vertex many", ""),
        (VERTICES + b"\n", b"element edge 12\n", ""),
        (b"_endian 1.0", b"_endian 2.0", ""),
        (b"property double support", b"property float support", ""),
        (b" ny\n", b" else\n", "file.ply' lacks the columns ny;"),
        (b"comment w", b"comment \xff", ""),
        (b"report {", b"report [", ""),
        (b'"samples": 12', b'"samples": []', ""),
        (b'"samples"', b'"simples"', ""),
        (b"ply\n", b"plywood\n", ""),
        (b"end_header\n", b"end_header\n\n", r"has [\d,]+ bytes instead of [\d,]+; write it again"),
        (f"binary_{sys.byteorder}_endian".encode(), b"ascii", r"is a text \.ply file"),
    ],
    ids=str,
)
def test_bad_headers(tmp_path, content, old, new, message, capsys):
    assert old in content
    (tmp_path / "file.ply").write_bytes(content.replace(old, new, 1))
    assert "file.ply" in unread(tmp_path / "file.ply", message)
    assert capsys.readouterr() == ("", "")


# --- damaged files --------------------------------------------------------------------------------


def read_of(path: Path, content: bytes | bytearray) -> gm.Samples | None:
    """Write a damaged file, and return what is read of it; None if it is refused."""
    path.write_bytes(content)
    with suppress(gm.errors.FileError):
        return read_samples(path)
    return None


def flipped(content: bytes, place: int, bit: int) -> bytearray:
    bad = bytearray(content)
    bad[place] ^= 1 << bit
    return bad


# Every seventh byte, and all of them.
steps = pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.slow)])


@steps
@every_readable
def test_truncated_anywhere(tmp_path, suffix, step, capsys):
    write_samples(make(5), tmp_path / f"file{suffix}")
    content = (tmp_path / f"file{suffix}").read_bytes()
    path = tmp_path / f"cut{suffix}"
    for length in range(0, len(content), step):
        path.write_bytes(content[:length])
        assert unread(path).startswith(f"'{path}' ")
    assert capsys.readouterr() == ("", "")


@steps
def test_any_damaged_byte_of_npz_is_noticed(tmp_path, step):
    path = tmp_path / "file.npz"
    write_samples(make(5), path)
    content = path.read_bytes()
    places = range(0, len(content), step)
    found = [read_of(path, flipped(content, place, place % 8)) for place in places]
    harmless = [x for x in found if x is not None]  # dates and the like
    for result in harmless:
        assert_same(make(5), result)
    assert len(harmless) < len(places) / 4


@steps
def test_any_damaged_byte_of_a_ply_header(tmp_path, step, capsys):
    path = tmp_path / "file.ply"
    write_samples(make(5), path)
    content = path.read_bytes()
    places = range(0, content.index(b"end_header\n") + len(b"end_header\n"), step)
    found = [read_of(path, flipped(content, x, bit)) for x in places for bit in (0, 1, 4, 7)]
    assert {len(x) for x in found if x is not None} == {5}
    assert found.count(None) > len(places)
    assert capsys.readouterr() == ("", "")


@every_readable
@pytest.mark.parametrize(
    "content",
    [
        b"", b"ply", b"ply\nformat binary_little_endian 1.0\nend_header\n",
        b"PK\x05\x06" + bytes(18),  # an empty zip archive
        os.urandom(1000),
    ],
)  # fmt: skip
def test_foreign_files(tmp_path, suffix, content):
    (tmp_path / f"file{suffix}").write_bytes(content)
    unread(tmp_path / f"file{suffix}", rf"file\{suffix}'")


def test_the_message_is_one_sentence_with_advice(tmp_path):
    path = tmp_path / "file.npz"
    np.save(path.with_suffix(".npy"), np.ones(3))
    for content in (b"PK", path.with_suffix(".npy").read_bytes()):
        path.write_bytes(content)
        assert unread(path) == f"'{path}' is damaged or is no .npz file; write it again."


# --- what is in .npz files ------------------------------------------------------------------------


class Bomb:
    """Unpickling it leaves a mark."""

    went_off = False

    def __reduce__(self) -> tuple[Any, ...]:
        return setattr, (Bomb, "went_off", True)


def write_npz(path: Path, **changes: Any) -> None:
    """Write an .npz with some entries changed, and those that are None left out."""
    samples = make()
    entries: dict[str, Any] = {name: getattr(samples, name) for name in FIELDS}
    entries |= {"report": json.dumps(asdict(samples.report)), "format_version": 1} | changes
    np.savez(path, **{name: e for name, e in entries.items() if e is not None})


def test_good_archives(tmp_path):
    """As NumPy writes them, compressed, and in the other byte order."""
    samples, plain, other = make(), tmp_path / "plain.npz", tmp_path / "file.npz"
    write_npz(plain)
    assert_same(samples, read_samples(plain))
    with (
        zipfile.ZipFile(plain) as archive,
        zipfile.ZipFile(other, "w", zipfile.ZIP_DEFLATED) as packed,
    ):
        for name in archive.namelist():
            packed.writestr(name, archive.read(name))
    assert_same(samples, read_samples(other))
    arrays = {name: getattr(samples, name) for name in FIELDS}
    write_npz(other, **{x: y.astype(y.dtype.newbyteorder()) for x, y in arrays.items()})
    assert_same(samples, read_samples(other))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        *[({x: None}, rf"file\.npz' lacks the arrays {x};")
          for x in ("points", "support", "patch_index", "report", "format_version")],
        (dict.fromkeys((*FIELDS[1:], "report", "format_version")),
         "arrays format_version, report, normals, uv, support"),
        ({"format_version": 2, "points": None},
         "comes from a newer version of gaussmap; update"),
        ({"points": np.ones((12, 2))}, "holds unusable samples: points must be"),
        ({"support": np.ones(11)}, "holds unusable samples: support must be"),
        ({"uv": np.ones((12, 2), np.float32)}, "holds unusable samples: uv must be"),
        ({"normal_index": np.ones(12)}, "holds unusable samples: normal_index must be"),
        ({"report": "{"}, "damaged"),
        ({"report": "[]"}, "damaged"),
        ({"report": "{}"}, "damaged"),
        ({"report": np.ones(3)}, "damaged"),
        ({"format_version": "one"}, "damaged"),
    ],
)  # fmt: skip
def test_wrong_entries(tmp_path, changes, message):
    write_npz(tmp_path / "file.npz", **changes)
    unread(tmp_path / "file.npz", message)


def test_pickles_are_never_read(tmp_path):
    bomb = np.empty(12, object)
    bomb[:] = Bomb()
    for name in FIELDS:
        write_npz(tmp_path / "file.npz", **{name: bomb})
        unread(tmp_path / "file.npz", "is no array of numbers")
    (tmp_path / "file.npz").write_bytes(pickle.dumps(Bomb()))
    unread(tmp_path / "file.npz", r"is damaged or is no \.npz file")
    assert not Bomb.went_off
    pickle.loads(pickle.dumps(Bomb()))
    assert Bomb.went_off  # so the bomb is a live one
    Bomb.went_off = False


# --- names ----------------------------------------------------------------------------------------


def test_the_suffixes():
    assert SUFFIXES == (
        ".npz", ".ply", ".csv", ".vtp", ".xyz", ".parquet", ".gpkg", ".geojson", ".las", ".laz",
    )  # fmt: skip
    assert READABLE_SUFFIXES == (".npz", ".ply")


@pytest.mark.parametrize("name", ["file.stl", "file", "file.npz.gz", ".npz", "file.", "."])
def test_unknown_suffixes(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    unknown, message = gm.errors.UnknownNameError, r"use one of \.npz, \.ply, \.csv, \.vtp, \.xyz"
    refused(message, write_samples, make(), name, error=unknown)
    for suffix in ("", *({*SUFFIXES} - {*READABLE_SUFFIXES})):
        unread(f"{name}{suffix}", r"use one of \.npz, \.ply\.$", unknown)
    refused("", check, name, error=unknown)
    assert litter(tmp_path) == []


@pytest.mark.parametrize(
    ("bad", "message"),
    [(None, "path"), (3, "path"), (b"file.npz", "path"), ("fi\0le.npz", "path"),
     ("", "the name of the file is empty")],
)  # fmt: skip
def test_what_is_not_a_path(bad, message):
    for call in (lambda p: write_samples(make(), p), read_samples, check):
        refused(message, call, bad)


# --- targets --------------------------------------------------------------------------------------


def write_by_hand(path: Any) -> None:
    with atomic_path(path) as temporary:
        temporary.write_text("new")


def not_written(path: Any, message: str) -> None:
    """Check that no writer takes a path, and that its folder stays as it is."""
    folder = Path(path).parent
    before = litter(folder) if folder.is_dir() else None
    for write in (lambda p: write_samples(make(), p), check, write_by_hand):
        refused(message, write, path, error=gm.errors.FileError)
    assert (litter(folder) if folder.is_dir() else None) == before


def test_folders_that_are_none(tmp_path):
    not_written(tmp_path / "no" / "file.npz", r"no/file\.npz' cannot.*no' does not exist; create")
    (tmp_path / "no").write_text("old")
    not_written(tmp_path / "no" / "file.npz", "no' is not a folder; create")
    not_written(tmp_path / "no" / "deep" / "file.npz", "deep' does not exist; create")
    assert (tmp_path / "no").read_text() == "old"
    not_written(tmp_path / ("n" * 300 + ".npz"), "cannot be written: File name too long")
    assert litter(tmp_path) == ["no"]


def test_targets_that_are_no_files(tmp_path):
    path = tmp_path / "file.npz"
    path.mkdir()
    not_written(path, r"file\.npz' is a folder; give the name")
    path.rmdir()
    path.symlink_to(path)
    not_written(path, "cannot be written: Too many levels")
    path.unlink()
    path.symlink_to(os.devnull)
    not_written(path, "is a device or a pipe")
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)
    if hasattr(os, "mkfifo"):
        path.unlink()
        os.mkfifo(path)
        not_written(path, "is a device or a pipe")
        assert path.is_fifo()


def test_a_protected_file(tmp_path, monkeypatch):
    (tmp_path / "file.npz").write_text("old")
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
    not_written(tmp_path / "file.npz", r"file\.npz' is write-protected; unprotect")
    assert (tmp_path / "file.npz").read_text() == "old"


@posix
def test_a_read_only_folder():
    """Nobody may write there, and we are nobody: root may write anywhere."""
    folder, user = Path(tempfile.mkdtemp()), os.geteuid()
    folder.chmod(0o555)
    if user == 0:
        os.seteuid(65534)
    try:
        message = "Permission denied; choose a folder that you may"
        not_written(folder / "file.npz", message)
    finally:
        os.seteuid(user)
        folder.chmod(0o755)
    folder.rmdir()


@every_suffix
def test_good_targets_leave_no_trace(tmp_path, suffix):
    check(tmp_path / f"file{suffix.upper()}")
    assert litter(tmp_path) == []
    (tmp_path / f"file{suffix}").write_text("old")
    check(str(tmp_path / f"file{suffix}"))
    assert litter(tmp_path) == [f"file{suffix}"]
    assert (tmp_path / f"file{suffix}").read_text() == "old"


def test_targets_of_other_suffixes_and_long_names(tmp_path):
    check_target(tmp_path / "picture.png", (".png", ".svg"))
    with pytest.raises(gm.errors.UnknownNameError, match=r"use one of \.png, \.svg"):
        check_target(tmp_path / "picture.npz", (".png", ".svg"))
    name = "n" * 251 + ".npz"
    check(tmp_path / name)
    write_samples(make(), tmp_path / name)
    assert litter(tmp_path) == [name]


@every_readable
def test_what_cannot_be_read(tmp_path, suffix):
    path = tmp_path / f"file{suffix}"
    unread(path, rf"file\{suffix}' cannot be read: No such file")
    path.mkdir()
    unread(path, rf"file\{suffix}' cannot be read: Is a directory")


# --- a file is complete, or not there -------------------------------------------------------------


def fail(path: Path, error: BaseException) -> None:
    """Write, then fail before the end."""
    before = os.listdir(path.parent)
    with atomic_path(path) as temporary:
        temporary.write_text("new")
        assert litter(path.parent, *before) == [temporary.name]
        raise error


@every_suffix
def test_any_exception_of_a_library_is_one_sentence(tmp_path, suffix, monkeypatch):
    error: BaseException = RuntimeError("out\nof " + 300 * "luck ")

    def broken(*_: object) -> None:
        raise error

    known = formats.OF_SAMPLES
    monkeypatch.setitem(known, suffix, known[suffix]._replace(write=broken))
    path = tmp_path / f"file{suffix}"
    with pytest.raises(gm.errors.FileError, match="RuntimeError: out of luck") as caught:
        write_samples(make(), path)
    said = str(caught.value)
    assert "\n" not in said
    assert said.endswith("make room, or choose another disk or format.")
    error = KeyboardInterrupt()  # which is of no library
    with pytest.raises(KeyboardInterrupt):
        write_samples(make(), path)
    assert litter(tmp_path) == []


@every_suffix
def test_a_full_disk(tmp_path, suffix):
    path = tmp_path / f"file{suffix}"
    path.write_text("old")
    pytest.importorskip("pyvista")  # before the limit: importing it writes files too
    message = rf"file\{suffix}' cannot.*File too large; make room"
    with pytest.raises(gm.errors.FileError, match=message), tiny_disk():
        write_samples(make(100), path)
    assert path.read_text() == "old"
    assert litter(tmp_path) == [path.name]


@pytest.mark.parametrize(
    "kind", [KeyboardInterrupt, SystemExit, ValueError, MemoryError, gm.errors.FileError]
)
def test_failure_inside(tmp_path, kind):
    path, error = tmp_path / "picture.png", kind("stop")
    for old in ([], ["picture.png"]):
        with pytest.raises(kind) as caught:
            fail(path, error)
        assert caught.value is error
        assert litter(tmp_path) == old
        assert not old or path.read_text() == "old"
        path.write_text("old")


@pytest.mark.parametrize(
    ("code", "hint"),
    [
        (errno.ENOSPC, "No space left on device; make room or choose another disk"),
        (errno.EROFS, "Read-only file system; choose a folder that you may write to"),
        (errno.EIO, "Input/output error; choose another place"),
    ],
)
def test_disk_errors_inside(tmp_path, code, hint):
    path = tmp_path / "picture.png"
    with pytest.raises(gm.errors.FileError) as caught:
        fail(path, OSError(code, os.strerror(code)))
    assert str(caught.value) == f"'{path}' cannot be written: {hint}."
    assert isinstance(caught.value.__cause__, OSError)
    assert litter(tmp_path) == []


def test_the_old_file_stands_until_the_end(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")
    with pytest.raises(gm.errors.FileError, match="No such file"), atomic_path(path):
        pass  # nothing is written
    assert path.read_text() == "old"
    with atomic_path(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"


def test_the_temporary_path(tmp_path):
    with atomic_path(str(tmp_path / "pic.ture.PNG")) as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".PNG"
        assert not temporary.exists()
        with atomic_path(tmp_path / "pic.ture.PNG") as second:
            assert second != temporary
            second.write_text("second")
        temporary.write_text("first")
    assert (tmp_path / "pic.ture.PNG").read_text() == "first"
    assert litter(tmp_path) == ["pic.ture.PNG"]


# --- permissions and links ------------------------------------------------------------------------


@posix
@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_permissions(tmp_path, mask):
    """New files follow the umask, and old ones keep theirs."""
    before = os.umask(mask)
    try:
        for suffix in SUFFIXES:
            write_samples(make(), tmp_path / f"file{suffix}")
            assert stat.S_IMODE((tmp_path / f"file{suffix}").stat().st_mode) == 0o666 & ~mask
    finally:
        os.umask(before)
    path = tmp_path / "file.npz"
    for mode in (0o600, 0o640, 0o664):
        path.chmod(mode)
        write_samples(make(7), path)
        assert stat.S_IMODE(path.stat().st_mode) == mode
    assert len(read_samples(path)) == 7


@posix
@pytest.mark.parametrize("exists", [True, False])
def test_links_are_followed(tmp_path, exists):
    (tmp_path / "real").mkdir()
    (tmp_path / "links").mkdir()
    real, link = tmp_path / "real" / "file.npz", tmp_path / "links" / "link.npz"
    if exists:
        real.write_text("old")
    link.symlink_to(real)
    write_samples(make(), link)
    assert link.is_symlink()
    assert len(read_samples(real)) == 12
    assert litter(tmp_path / "links") == ["link.npz"]
    assert litter(tmp_path / "real") == ["file.npz"]
    (tmp_path / "link.npz").symlink_to(tmp_path / "no" / "file.npz")
    with pytest.raises(gm.errors.FileError, match=r"link\.npz' cannot.*no' does not exist"):
        write_samples(make(), tmp_path / "link.npz")


# --- files of some fields -------------------------------------------------------------------------


def test_fields_are_chosen(tmp_path: Path) -> None:
    samples = gm.sample("torus", 60, cells=(8, 8))
    wanted = ("normals", "points", "normal_index")
    for suffix in (".npz", ".ply"):
        path = tmp_path / f"some{suffix}"
        samples.write(path, fields=wanted)
        found = gm.read_samples(path)
        assert {*found.fields} == {*wanted}
        np.testing.assert_array_equal(found.normals, samples.normals)
        assert found.report.samples == 60
    samples.write(tmp_path / "some.csv", fields=["support"])
    assert (tmp_path / "some.csv").read_text().splitlines()[0] == "support"


def test_unusable_fields(tmp_path: Path) -> None:
    samples = gm.sample("torus", 60, fields=("points", "normals"), cells=(8, 8))
    for fields, message in (
        ("points", "fields must be a tuple of names, not 'points'"),
        (("uv",), "there is no field of these samples 'uv'; there is points, normals"),
        ((), "samples need at least one array"),
    ):
        with pytest.raises(gm.GaussmapError, match=message):
            samples.write(tmp_path / "some.ply", fields=fields)
    assert not [*tmp_path.iterdir()]


# --- headers of .ply files of others --------------------------------------------------------------

POINTS = ["property float x", "property float y", "property float z"]
OF_POINTS = "comment gaussmap fields points"


def write(path: Path, *lines: str, body: bytes = b"", end: str = "\n") -> None:
    header = ["ply", "format binary_little_endian 1.0", *lines, "end_header", ""]
    path.write_bytes(end.join(header).encode() + body)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_line_ends(tmp_path, end):
    body = np.arange(6, dtype="<f4").tobytes()
    write(tmp_path / "a.ply", OF_POINTS, "element vertex 2", *POINTS, body=body, end=end)
    read = gm.read_samples(tmp_path / "a.ply")
    assert read.points.dtype == np.float32
    assert read.points.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_whole_numbers_are_widened(tmp_path):
    kinds = ["property short x", "property uint8 y", "property int32 z"]
    row = np.array([(-7, 200, 1 << 30)], "<i2,u1,<i4")
    write(tmp_path / "a.ply", OF_POINTS, "element vertex 1", *kinds, body=row.tobytes())
    read = gm.read_samples(tmp_path / "a.ply").points
    assert read.dtype == np.float64
    assert read.tolist() == [[-7, 200, 1 << 30]]


def test_elements_behind_the_vertices_are_left_out(tmp_path):
    others = ["element face 1", "property list uchar int vertex_index", "element edge 0"]
    write(tmp_path / "a.ply", OF_POINTS, "element vertex 1", *POINTS, *others, body=bytes(12 + 13))
    assert len(gm.read_samples(tmp_path / "a.ply")) == 1


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["element face 0", "element vertex 0", *POINTS], "does not begin with vertices"),
        (["element vertex 0", "property list uchar float x"], "has 'property list uchar float x'"),
        (["element vertex 0", "property float x", "property int x"], "has 'property int x' in its"),
        (["element vertex 0", "property object x"], "has 'property object x' in its"),
        (["element vertex 0", "property V9999999999 x"], "has 'property V9999999999 x' in its"),
        (["property float x", "element vertex 0"], "lacks the columns x, y, z"),
        (["element vertex 99999999999999999999", *POINTS], "ends early; write it again"),
        (["element vertex " + 9999 * "9", *POINTS], "damaged .*ValueError"),
        (["element vertex 0", "property " + 9999 * "x"], r"a\.ply' has .{52} in its header"),
        ([*(1 << 20) * ["comment"]], "ends within its header"),
        (["comment gaussmap report " + 99999 * "[", "element vertex 0", *POINTS], "damaged"),
        (["element vertex 99999999999999999999"], "lacks the columns x, y, z"),
    ],
)
def test_hostile_headers(tmp_path, lines, message):
    write(tmp_path / "a.ply", OF_POINTS, *lines)
    said = refused(message, gm.read_samples, tmp_path / "a.ply", error=gm.errors.FileError)
    assert len(said) < 1000


def test_the_format_comes_first(tmp_path):
    write(tmp_path / "a.ply", OF_POINTS, "element vertex 1", *POINTS, body=bytes(12))
    content = (tmp_path / "a.ply").read_bytes()
    line = b"format binary_little_endian 1.0\n"
    late = content.replace(line, b"").replace(b"end_header\n", line + b"end_header\n")
    (tmp_path / "a.ply").write_bytes(late)
    with pytest.raises(gm.errors.FileError, match="has 'property float x' in its header"):
        gm.read_samples(tmp_path / "a.ply")


def test_a_file_without_lines(tmp_path):
    (tmp_path / "a.ply").write_bytes(b"ply\n" + bytes(1 << 24))
    with pytest.raises(gm.errors.FileError, match="ends within its header"):
        gm.read_samples(tmp_path / "a.ply")
