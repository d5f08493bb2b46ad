from __future__ import annotations

import builtins
import errno
import json
import os
import pickle
import re
import stat
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pyarrow
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.files import formats
from gaussmap.tools.files.formats import (
    READABLE_SUFFIXES,
    SUFFIXES,
    read_samples,
    write_samples,
)
from gaussmap.tools.files.paths import atomic_path, check_target

COLUMNS = [
    *("x", "y", "z", "nx", "ny", "nz", "u", "v", "support"),
    *("gaussian_curvature", "mean_curvature", "normal_index", "patch_index"),
]

# Labels that a careless format would break: line ends, quotes, other alphabets, trailing spaces.
LABEL = ' x²\r\n"y" <&> \\ \u2028 \U0001f369 ' + 300 * " " + "end_header\ncomment "

FIELDS = (
    "points", "normals", "uv", "support", "gaussian_curvature", "mean_curvature", "normal_index",
    "patch_index",
)  # fmt: skip

every_suffix = pytest.mark.parametrize("suffix", SUFFIXES)
every_readable = pytest.mark.parametrize("suffix", READABLE_SUFFIXES)


def make(count: int = 12, label: str = "torus") -> gm.Samples:
    """Random numbers of all sizes, signed zeros and non-finite values among the curvatures."""
    rng = np.random.default_rng(count)
    # Not beyond 1e140: VTK's reader warns if it finds vectors whose squared length overflows.
    arrays: dict[str, Any] = {
        name: rng.standard_normal((count, *tail)) * 10.0 ** rng.integers(-300, 140, (count, *tail))
        for name, tail in [("points", (3,)), ("normals", (3,)), ("uv", (2,)), ("support", ())]
    }
    special = np.resize([-0.0, 0.0, np.inf, -np.inf, np.nan, 5e-324, -1.1, 0.1], count)
    return gm.Samples(
        **arrays,
        gaussian_curvature=special,
        mean_curvature=special[::-1].copy(),
        normal_index=rng.integers(0, 2**31, count),
        patch_index=rng.integers(0, 99, count),
        report=SamplingReport(label, 8, count, 99, 1.0 / 3.0, 1),
    )


def columns_of(samples: gm.Samples) -> dict[str, np.ndarray]:
    """The 13 columns, spelled out apart from the code under test."""
    flat = [*samples.points.T, *samples.normals.T, *samples.uv.T]
    flat += [samples.support, samples.gaussian_curvature, samples.mean_curvature]
    flat += [samples.normal_index, samples.patch_index]
    return dict(zip(COLUMNS, flat, strict=True))


def assert_same(samples: gm.Samples, other: gm.Samples) -> None:
    """Equal bit for bit, report included."""
    assert other.report == samples.report
    for name in FIELDS:
        mine, yours = getattr(samples, name), getattr(other, name)
        assert (yours.dtype, yours.shape) == (mine.dtype, mine.shape)
        assert yours.tobytes() == mine.tobytes(), name
        assert yours.flags.c_contiguous
        assert yours.flags.writeable


def assert_bits(actual: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_array_equal(actual, expected)
    np.testing.assert_array_equal(np.signbit(actual), np.signbit(expected))


def vertices_by_trimesh(path: Path) -> np.ndarray:
    """Read the vertices of a .ply file as rows with names."""
    trimesh = pytest.importorskip("trimesh")
    with open(path, "rb") as file:
        return trimesh.exchange.ply.load_ply(file)["metadata"]["_ply_raw"]["vertex"]["data"]


def check(path: Any) -> None:
    check_target(path, SUFFIXES)


def litter(folder: Path, *expected: str) -> list[str]:
    return sorted(set(os.listdir(folder)) - set(expected))


@contextmanager
def tiny_disk() -> Iterator[None]:
    """No file can grow beyond 500 bytes: the closest to a full disk that needs no real one.

    Keep it round the one call that must fail: pytest's own log is a file too.
    """
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (500, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def read_only_folder() -> Iterator[Path]:
    """A folder where nobody may write, and we are nobody: root may write anywhere."""
    if not hasattr(os, "geteuid"):
        pytest.skip("needs POSIX permissions")
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o555)
    user = os.geteuid()
    if user == 0:
        os.seteuid(65534)
    yield folder
    os.seteuid(user)
    folder.chmod(0o755)
    left = litter(folder)
    folder.rmdir()
    assert left == []


class TestEarlierVersions:
    @pytest.mark.parametrize(
        ("old", "new"), [("isotropic", None), ("mixed", "aligned"), ("aligned", "aligned")]
    )
    def test_the_density_of_version_0_1(self, tmp_path, old, new):
        path = tmp_path / "file.npz"
        make().write(path)
        with np.load(path) as archive:
            arrays = dict(archive)
        text = str(arrays["report"]).replace('"density": null', f'"density": "{old}"')
        assert old in text
        np.savez(path, **(arrays | {"report": np.array(text)}))  # pyright: ignore[reportArgumentType]
        assert read_samples(path).report.density == new


class TestRoundTrip:
    @every_readable
    @pytest.mark.parametrize("count", [0, 1, 2, 12, 5000])
    def test_bit_for_bit(self, tmp_path, suffix, count):
        samples = make(count)
        write_samples(samples, tmp_path / f"file{suffix}")
        assert_same(samples, read_samples(tmp_path / f"file{suffix}"))

    @every_readable
    def test_any_label(self, tmp_path, suffix):
        samples = make(label=LABEL)
        write_samples(samples, tmp_path / f"file{suffix}")
        assert_same(samples, read_samples(tmp_path / f"file{suffix}"))

    @every_readable
    def test_unknown_numbers(self, tmp_path, suffix):
        samples = replace(make(), report=SamplingReport("s", None, 12, None, None, None))
        write_samples(samples, tmp_path / f"file{suffix}")
        assert_same(samples, read_samples(tmp_path / f"file{suffix}"))

    @every_readable
    def test_whether_samples_are_on_the_surface(self, tmp_path, suffix):
        there = np.arange(12) % 3 > 0
        report = replace(make().report, on="surface", unrefined=4)
        report = replace(report, fit_distance=1e-5, fit_rms=6e-6, fit_angle=0.03)
        samples = replace(make(), on_surface=there, report=report)
        samples.write(tmp_path / f"out{suffix}")
        other = read_samples(tmp_path / f"out{suffix}")
        assert_same(samples, other)
        assert other.on_surface is not None
        assert other.on_surface.dtype == np.bool_
        np.testing.assert_array_equal(other.on_surface, there)

    @every_readable
    def test_a_part_keeps_the_report(self, tmp_path, suffix):
        part = make()[3:5]
        write_samples(part, tmp_path / f"file{suffix}")
        assert_same(part, read_samples(tmp_path / f"file{suffix}"))
        assert part.report.samples == 12

    @every_suffix
    def test_the_suffix_may_be_in_capitals(self, tmp_path, suffix):
        write_samples(make(), tmp_path / f"small{suffix}")
        write_samples(make(), tmp_path / f"CAPS{suffix.upper()}")
        assert litter(tmp_path) == sorted([f"small{suffix}", f"CAPS{suffix.upper()}"])
        small = (tmp_path / f"small{suffix}").read_bytes()
        assert (tmp_path / f"CAPS{suffix.upper()}").read_bytes() == small
        if suffix in READABLE_SUFFIXES:
            assert_same(make(), read_samples(tmp_path / f"CAPS{suffix.upper()}"))

    @every_suffix
    def test_equal_samples_make_equal_files(self, tmp_path, suffix, monkeypatch):
        write_samples(make(), tmp_path / f"one{suffix}")
        later = 2.0e9
        monkeypatch.setattr("time.time", lambda: later)
        write_samples(make(), tmp_path / f"two{suffix}")
        assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"two{suffix}").read_bytes()

    @every_suffix
    def test_path_as_text_and_relative(self, tmp_path, suffix, monkeypatch):
        monkeypatch.chdir(tmp_path)
        write_samples(make(), f"a b.c{suffix}")
        assert litter(tmp_path) == [f"a b.c{suffix}"]

    @every_suffix
    def test_read_only_arrays(self, tmp_path, suffix):
        samples = make()
        for name in FIELDS:
            getattr(samples, name).setflags(write=False)
        write_samples(samples, tmp_path / f"file{suffix}")
        assert (tmp_path / f"file{suffix}").stat().st_size > 500


class TestOtherReaders:
    """What other programs find in the files."""

    @pytest.mark.parametrize("count", [0, 1, 12, pytest.param(5000, marks=pytest.mark.slow)])
    def test_csv(self, tmp_path, count):
        samples = make(count)
        write_samples(samples, tmp_path / "file.csv")
        lines = (tmp_path / "file.csv").read_bytes().decode("ascii").splitlines()
        assert lines[0] == ",".join(COLUMNS)
        table = np.array([line.split(",") for line in lines[1:]], float).reshape(count, 13)
        for name, column in columns_of(samples).items():
            assert_bits(table[:, COLUMNS.index(name)], column)
        assert all(re.fullmatch(r"\d+,\d+", ",".join(line.split(",")[11:])) for line in lines[1:])

    def test_csv_with_numpy(self, tmp_path):
        samples = make()
        write_samples(samples, tmp_path / "file.csv")
        table = np.genfromtxt(tmp_path / "file.csv", delimiter=",", names=True)
        for name, column in columns_of(samples).items():
            assert_bits(table[name], column)

    @pytest.mark.parametrize("count", [1, 12, 5000])
    def test_xyz_with_numpy(self, tmp_path, count):
        samples = make(count)
        write_samples(samples, tmp_path / "file.xyz")
        table = np.loadtxt(tmp_path / "file.xyz", ndmin=2)
        assert_bits(table, np.hstack([samples.points, samples.normals]))

    def test_xyz_without_samples(self, tmp_path):
        write_samples(make(0), tmp_path / "file.xyz")
        assert (tmp_path / "file.xyz").read_bytes() == b""

    def test_npz_with_numpy(self, tmp_path):
        samples = make()
        write_samples(samples, tmp_path / "file.npz")
        with np.load(tmp_path / "file.npz", allow_pickle=False) as archive:
            assert set(archive) == {*FIELDS, "report", "format_version"}
            assert archive["format_version"] == 1
            assert json.loads(str(archive["report"])) == asdict(samples.report)
            for name in FIELDS:
                assert_bits(archive[name], getattr(samples, name))

    @pytest.mark.parametrize("count", [1, 12])
    def test_ply_with_pyvista(self, tmp_path, count):
        pv = pytest.importorskip("pyvista")
        # VTK hands on only some of the vertices' properties, and those in single precision.
        samples = replace(make(count), points=np.arange(3.0 * count).reshape(count, 3))
        samples = replace(samples, normals=-samples.points)
        write_samples(samples, tmp_path / "file.ply")
        cloud = pv.read(tmp_path / "file.ply")
        np.testing.assert_array_equal(cloud.points, samples.points)
        np.testing.assert_array_equal(cloud.point_data["Normals"], samples.normals)

    def test_ply_with_trimesh(self, tmp_path):
        samples = make()
        write_samples(samples, tmp_path / "file.ply")
        vertices = vertices_by_trimesh(tmp_path / "file.ply")
        expected = columns_of(samples)
        assert list(vertices.dtype.names or ()) == COLUMNS
        for name in COLUMNS:
            assert_bits(vertices[name], expected[name])

    def test_ply_header(self, tmp_path):
        write_samples(make(), tmp_path / "file.ply")
        header, body = (tmp_path / "file.ply").read_bytes().split(b"end_header\n", 1)
        lines = header.decode("ascii").splitlines()
        assert lines[:2] == ["ply", f"format binary_{sys.byteorder}_endian 1.0"]
        assert lines[2] == "comment written by gaussmap"
        plain = [line for line in lines[2:] if not line.startswith("comment ")]
        types = ["double"] * 11 + ["int"] * 2
        assert plain == [
            "element vertex 12",
            *(f"property {kind} {name}" for kind, name in zip(types, COLUMNS, strict=True)),
        ]
        assert len(body) == 12 * (11 * 8 + 2 * 4)

    def test_ply_header_lines_stay_short(self, tmp_path):
        write_samples(make(label=LABEL * 9), tmp_path / "file.ply")
        header = (tmp_path / "file.ply").read_bytes().split(b"\nend_header\n", 1)[0]
        assert len(header) > 3000
        assert max(len(line) for line in header.split(b"\n")) < 255

    @pytest.mark.parametrize("count", [0, 1, 12])
    def test_vtp_with_pyvista(self, tmp_path, count):
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

    def test_ply_without_samples(self, tmp_path):
        write_samples(make(0), tmp_path / "file.ply")
        vertices = vertices_by_trimesh(tmp_path / "file.ply")
        assert vertices.shape == (0,)
        assert list(vertices.dtype.names or ()) == COLUMNS


class TestForeignPly:
    """.ply files that another program rewrote."""

    def rewrite(self, path: Path, faces: bytes = b"", **columns: np.ndarray) -> gm.Samples:
        """Write samples as others do, with some columns changed."""
        samples = make()
        data = columns_of(samples) | columns
        rows = np.empty(12, [(name, column.dtype) for name, column in data.items()])
        for name, column in data.items():
            rows[name] = column
        header = [f"format binary_{sys.byteorder}_endian 1.0", "comment by another program"]
        header += ["obj_info and more of it", "element vertex 12"]
        header += [f"property {column.dtype} {name}" for name, column in data.items()]
        if faces:
            header += ["element face 4", "property list uint8 int32 vertex_indices"]
        with open(path, "wb") as file:
            file.write("\n".join(["ply", *header, "end_header\n"]).encode())
            file.write(rows.tobytes() + faces)
        return samples

    def test_the_report_is_unknown_then(self, tmp_path):
        samples = self.rewrite(tmp_path / "file.ply")
        other = read_samples(tmp_path / "file.ply")
        assert other.report == SamplingReport("an unknown surface", None, 12, None, None, None)
        assert_same(replace(samples, report=other.report), other)
        assert other.summary().startswith("12 samples (")
        assert repr(other).startswith("Samples(12 points on an unknown surface: ")

    def test_more_columns(self, tmp_path):
        samples = self.rewrite(tmp_path / "file.ply", red=np.ones(12, np.uint8))
        assert_bits(read_samples(tmp_path / "file.ply").support, samples.support)

    def test_single_precision(self, tmp_path):
        with np.errstate(all="ignore"):
            single = make().support.astype(np.float32)
        self.rewrite(tmp_path / "file.ply", support=single)
        assert_bits(read_samples(tmp_path / "file.ply").support, single.astype(float))

    def test_faces(self, tmp_path):
        samples = self.rewrite(tmp_path / "file.ply", faces=4 * (b"\3" + bytes(12)))
        assert_bits(read_samples(tmp_path / "file.ply").points, samples.points)

    def test_the_other_byte_order(self, tmp_path):
        samples = make()
        write_samples(samples, tmp_path / "file.ply")
        header, body = (tmp_path / "file.ply").read_bytes().split(b"end_header\n", 1)
        row = np.dtype([("f", "f8", 11), ("i", "i4", 2)])
        swapped = np.frombuffer(body, row).byteswap().tobytes()
        for here, there in [(b"little", b"big"), (b"big", b"little")]:
            if header.count(here):
                header = header.replace(here, there)
                break
        (tmp_path / "file.ply").write_bytes(header + b"end_header\n" + swapped)
        assert_same(samples, read_samples(tmp_path / "file.ply"))

    @pytest.mark.parametrize(
        ("name", "column", "kind"),
        [("normal_index", np.ones(12), "float64"), ("patch_index", np.ones(12, "u8"), "uint64")],
    )
    def test_indices_must_be_integers(self, tmp_path, name, column, kind):
        self.rewrite(tmp_path / "file.ply", **{name: column})
        with pytest.raises(gm.errors.FileError, match=f"has {kind} numbers as {name}"):
            read_samples(tmp_path / "file.ply")

    @pytest.mark.parametrize("gone", COLUMNS)
    def test_missing_columns_are_named(self, tmp_path, gone):
        write_samples(make(), tmp_path / "file.ply")
        content = (tmp_path / "file.ply").read_bytes()
        (tmp_path / "file.ply").write_bytes(content.replace(f" {gone}\n".encode(), b" else\n"))
        with pytest.raises(gm.errors.FileError, match=rf"file.ply' lacks the columns {gone};"):
            read_samples(tmp_path / "file.ply")

    def test_text_ply(self, tmp_path):
        columns = [f"property double {name}" for name in "xyz"]
        header = ["ply", "format ascii 1.0", "element vertex 2", *columns, "end_header"]
        (tmp_path / "file.ply").write_text("\n".join([*header, "1 1 1", "1 1 1\n"]))
        with pytest.raises(gm.errors.FileError, match=r"is a text \.ply file"):
            read_samples(tmp_path / "file.ply")

    @pytest.mark.parametrize(
        "change",
        [
            (b"element vertex 12", b"element vertex 11"),
            (b"element vertex 12", b"element vertex 13"),
            (b"element vertex 12", b"element vertex 0"),
            (b"element vertex 12", b"element vertex 1" + 30 * b"0"),
            (b"element vertex 12", b"element vertex 1" + 9 * b"0"),
            (b"element vertex 12", b"element vertex -1"),
            (b"element vertex 12", b"element vertex many"),
            (b"element vertex 12", b"element vertex"),
            (b"element vertex 12\n", b"element edge 12\n"),
            (b"_endian 1.0", b"_endian 2.0"),
            (b"property double x", b"property triple x"),
            (b"property double x", b"property x"),
            (b"property double support", b"property float support"),
            (b"property double x\n", b"property double x\nproperty double x\n"),
            (b"property double x", b"property list uchar int x"),
            (b"comment w", b"comment \xff"),
            (b"report {", b"report ["),
            (b"report {", b"report "),
            (b'"samples": 12', b'"samples": -2'),
            (b'"samples"', b'"simples"'),
            (b"ply\n", b"plywood\n"),
        ],
        ids=str,
    )
    def test_bad_headers(self, tmp_path, change, capsys):
        write_samples(make(), tmp_path / "file.ply")
        content = (tmp_path / "file.ply").read_bytes()
        assert change[0] in content
        (tmp_path / "file.ply").write_bytes(content.replace(*change, 1))
        with pytest.raises(gm.errors.FileError, match=r"file\.ply"):
            read_samples(tmp_path / "file.ply")
        assert capsys.readouterr() == ("", "")

    def test_nothing_is_allocated_for_vertices_that_cannot_be_there(self, tmp_path):
        write_samples(make(), tmp_path / "file.ply")
        content = (tmp_path / "file.ply").read_bytes()
        content = content.replace(b"element vertex 12", b"element vertex 12000000000")
        (tmp_path / "file.ply").write_bytes(content)
        with pytest.raises(gm.errors.FileError, match="ends early; write it again"):
            read_samples(tmp_path / "file.ply")

    def test_trailing_bytes(self, tmp_path):
        write_samples(make(), tmp_path / "file.ply")
        with open(tmp_path / "file.ply", "ab") as file:
            file.write(b"\n")
        with pytest.raises(
            gm.errors.FileError, match=r"has [\d,]+ bytes instead of [\d,]+; write it again"
        ):
            read_samples(tmp_path / "file.ply")


class TestIndicesInPly:
    def test_the_largest(self, tmp_path):
        samples = replace(make(2), normal_index=np.array([-(2**31), 2**31 - 1]))
        write_samples(samples, tmp_path / "file.ply")
        assert_same(samples, read_samples(tmp_path / "file.ply"))

    @pytest.mark.parametrize("name", ["normal_index", "patch_index"])
    @pytest.mark.parametrize("value", [2**31, -(2**31) - 1, 2**32])
    def test_too_large(self, tmp_path, name, value):
        samples = replace(make(2), **{name: np.array([0, value])})
        with pytest.raises(
            gm.errors.InputError, match=rf"^{name} goes up to {abs(value):,}, but a \.ply"
        ):
            write_samples(samples, tmp_path / "file.ply")
        assert litter(tmp_path) == []
        write_samples(samples, tmp_path / "file.npz")
        assert_same(samples, read_samples(tmp_path / "file.npz"))


# Every seventh byte, and all of them.
steps = pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.slow)])


class TestDamagedFiles:
    @steps
    @every_readable
    def test_truncated_anywhere(self, tmp_path, suffix, step, capsys):
        write_samples(make(5), tmp_path / f"file{suffix}")
        content = (tmp_path / f"file{suffix}").read_bytes()
        path = tmp_path / f"cut{suffix}"
        for length in range(0, len(content), step):
            path.write_bytes(content[:length])
            with pytest.raises(gm.errors.FileError) as caught:
                read_samples(path)
            assert str(caught.value).startswith(f"'{path}' ")
            assert "\n" not in str(caught.value)
        assert capsys.readouterr() == ("", "")

    @steps
    def test_any_damaged_byte_of_npz_is_noticed(self, tmp_path, step):
        samples = make(5)
        write_samples(samples, tmp_path / "file.npz")
        content = (tmp_path / "file.npz").read_bytes()
        path, harmless = tmp_path / "bad.npz", 0
        places = range(0, len(content), step)
        for place in places:
            bad = bytearray(content)
            bad[place] ^= 1 << place % 8
            path.write_bytes(bad)
            try:
                result = read_samples(path)
            except gm.errors.FileError:
                continue
            # Dates and the like; what is read is read right.
            assert_same(samples, result)
            harmless += 1
        assert harmless < len(places) / 4

    @steps
    def test_any_damaged_byte_of_a_ply_header(self, tmp_path, step, capsys):
        write_samples(make(5), tmp_path / "file.ply")
        content = (tmp_path / "file.ply").read_bytes()
        path, noticed = tmp_path / "bad.ply", 0
        places = range(0, content.index(b"end_header\n") + len(b"end_header\n"), step)
        for place in places:
            for bit in (0, 1, 4, 7):
                bad = bytearray(content)
                bad[place] ^= 1 << bit
                path.write_bytes(bad)
                try:
                    assert len(read_samples(path)) == 5
                except gm.errors.FileError:
                    noticed += 1
        assert noticed > len(places)
        assert capsys.readouterr() == ("", "")

    @every_readable
    @pytest.mark.parametrize(
        "content",
        [
            b"",
            b"\n",
            b"ply",
            b"ply\nend_header\n",
            b"ply\nformat binary_little_endian 1.0\nend_header\n",
            b"\x89PNG\r\n\x1a\n",
            b"PK\x03\x04" + bytes(40),
            b"PK\x05\x06" + bytes(18),  # an empty zip archive
            b"x,y,z\n1,2,3\n",
            bytes(1000),
            os.urandom(1000),
        ],
    )
    def test_foreign_files(self, tmp_path, suffix, content):
        (tmp_path / f"file{suffix}").write_bytes(content)
        with pytest.raises(gm.errors.FileError, match=rf"file\{suffix}'"):
            read_samples(tmp_path / f"file{suffix}")

    def test_a_plain_numpy_array(self, tmp_path):
        with open(tmp_path / "file.npz", "wb") as file:
            np.save(file, np.ones(3))
        with pytest.raises(gm.errors.FileError, match=r"is damaged or is no \.npz file"):
            read_samples(tmp_path / "file.npz")

    def test_the_message_is_one_sentence_with_advice(self, tmp_path):
        (tmp_path / "file.npz").write_bytes(b"PK")
        with pytest.raises(gm.errors.FileError) as caught:
            read_samples(tmp_path / "file.npz")
        assert str(caught.value) == (
            f"'{tmp_path / 'file.npz'}' is damaged or is no .npz file; write it again."
        )

    @every_readable
    def test_the_file_is_closed(self, tmp_path, suffix, monkeypatch):
        opened = []
        real = builtins.open

        def spy(*args: Any, **options: Any) -> Any:
            opened.append(real(*args, **options))
            return opened[-1]

        write_samples(make(), tmp_path / f"good{suffix}")
        (tmp_path / f"bad{suffix}").write_bytes((tmp_path / f"good{suffix}").read_bytes()[:-9])
        monkeypatch.setattr(builtins, "open", spy)
        read_samples(tmp_path / f"good{suffix}")
        with pytest.raises(gm.errors.FileError):
            read_samples(tmp_path / f"bad{suffix}")
        monkeypatch.undo()
        assert len(opened) == 2
        assert all(file.closed for file in opened)


class Bomb:
    """Unpickling it leaves a mark."""

    went_off = False

    def __reduce__(self) -> tuple[Any, ...]:
        return setattr, (Bomb, "went_off", True)


class TestNpzContent:
    def rewrite(self, path: Path, **changes: Any) -> None:
        """Write an .npz with some entries changed, and those that are None left out."""
        samples = make()
        entries: dict[str, Any] = {name: getattr(samples, name) for name in FIELDS}
        entries |= {"report": json.dumps(asdict(samples.report)), "format_version": 1} | changes
        np.savez(path, **{name: e for name, e in entries.items() if e is not None})

    def test_what_the_helper_writes_is_good(self, tmp_path):
        self.rewrite(tmp_path / "file.npz")
        assert_same(make(), read_samples(tmp_path / "file.npz"))

    @pytest.mark.parametrize("gone", [*FIELDS, "report", "format_version"])
    def test_missing_arrays_are_named(self, tmp_path, gone):
        self.rewrite(tmp_path / "file.npz", **{gone: None})
        with pytest.raises(gm.errors.FileError, match=rf"file\.npz' lacks the arrays {gone};"):
            read_samples(tmp_path / "file.npz")

    def test_all_missing_arrays_are_named(self, tmp_path):
        np.savez(tmp_path / "file.npz", points=np.ones((2, 3)))
        with pytest.raises(
            gm.errors.FileError, match="arrays format_version, report, normals, uv, support"
        ):
            read_samples(tmp_path / "file.npz")

    def test_a_newer_version(self, tmp_path):
        self.rewrite(tmp_path / "file.npz", format_version=2, points=None)
        with pytest.raises(
            gm.errors.FileError, match="comes from a newer version of gaussmap; update"
        ):
            read_samples(tmp_path / "file.npz")

    @pytest.mark.parametrize("name", FIELDS)
    def test_pickles_are_never_read(self, tmp_path, name):
        bomb = np.empty(12, object)
        bomb[:] = Bomb()
        self.rewrite(tmp_path / "file.npz", **{name: bomb})
        with pytest.raises(gm.errors.FileError, match="is no array of numbers"):
            read_samples(tmp_path / "file.npz")
        assert not Bomb.went_off

    def test_a_bare_pickle_is_never_read(self, tmp_path):
        (tmp_path / "file.npz").write_bytes(pickle.dumps(Bomb()))
        with pytest.raises(gm.errors.FileError, match=r"is damaged or is no \.npz file"):
            read_samples(tmp_path / "file.npz")
        assert not Bomb.went_off
        pickle.loads(pickle.dumps(Bomb()))
        assert Bomb.went_off  # so the bomb is a live one
        Bomb.went_off = False

    @pytest.mark.parametrize(
        ("name", "value", "message"),
        [
            ("points", np.ones((12, 2)), "holds unusable samples: points must be"),
            ("support", np.ones(11), "holds unusable samples: support must be"),
            ("uv", np.ones((12, 2), np.float32), "holds unusable samples: uv must be"),
            ("normal_index", np.ones(12), "holds unusable samples: normal_index must be"),
            ("report", "{", "damaged"),
            ("report", "[]", "damaged"),
            ("report", "{}", "damaged"),
            ("report", np.ones(3), "damaged"),
            ("format_version", "one", "damaged"),
        ],
    )
    def test_wrong_entries(self, tmp_path, name, value, message):
        self.rewrite(tmp_path / "file.npz", **{name: value})
        with pytest.raises(gm.errors.FileError, match=message):
            read_samples(tmp_path / "file.npz")

    def test_the_other_byte_order(self, tmp_path):
        samples = make()
        swapped = {
            name: (array := getattr(samples, name)).astype(array.dtype.newbyteorder())
            for name in FIELDS
        }
        self.rewrite(tmp_path / "file.npz", **swapped)
        assert_same(samples, read_samples(tmp_path / "file.npz"))

    def test_compressed_archives(self, tmp_path):
        self.rewrite(tmp_path / "plain.npz")
        with (
            zipfile.ZipFile(tmp_path / "plain.npz") as plain,
            zipfile.ZipFile(tmp_path / "file.npz", "w", zipfile.ZIP_DEFLATED) as packed,
        ):
            for name in plain.namelist():
                packed.writestr(name, plain.read(name))
        assert_same(make(), read_samples(tmp_path / "file.npz"))


class TestNames:
    def test_the_suffixes(self):
        assert SUFFIXES == (
            ".npz", ".ply", ".csv", ".vtp", ".xyz", ".parquet", ".arrow", ".feather",
            ".las", ".laz",
        )  # fmt: skip
        assert READABLE_SUFFIXES == (".npz", ".ply")

    def test_no_name(self):
        for call in (lambda: write_samples(make(), ""), lambda: read_samples("")):
            with pytest.raises(gm.errors.InputError, match="the name of the file is empty"):
                call()

    @pytest.mark.parametrize("name", ["file.stl", "file", "file.npz.gz", ".npz", "file.", "."])
    def test_unknown_suffixes(self, tmp_path, monkeypatch, name):
        monkeypatch.chdir(tmp_path)
        with pytest.raises(
            gm.errors.UnknownNameError, match=r"use one of \.npz, \.ply, \.csv, \.vtp, \.xyz"
        ):
            write_samples(make(), name)
        with pytest.raises(gm.errors.UnknownNameError, match=r"use one of \.npz, \.ply\.$"):
            read_samples(name)
        with pytest.raises(gm.errors.UnknownNameError):
            check(name)
        assert litter(tmp_path) == []

    @pytest.mark.parametrize("suffix", sorted(set(SUFFIXES) - set(READABLE_SUFFIXES)))
    def test_write_only_suffixes(self, tmp_path, suffix):
        write_samples(make(), tmp_path / f"file{suffix}")
        with pytest.raises(
            gm.errors.UnknownNameError, match=rf"the suffix '\{suffix}'; use one of \.npz"
        ):
            read_samples(tmp_path / f"file{suffix}")

    @pytest.mark.parametrize("bad", [None, 3, b"file.npz", "fi\0le.npz"])
    @pytest.mark.parametrize("call", [lambda p: write_samples(make(), p), read_samples, check])
    def test_not_a_path(self, bad, call):
        with pytest.raises(gm.errors.InputError, match="path"):
            call(bad)


def write_by_hand(path: Any) -> None:
    with atomic_path(path) as temporary:
        temporary.write_text("new")


every_writer = pytest.mark.parametrize(
    "write",
    [lambda p: write_samples(make(), p), check, write_by_hand],
    ids=["write_samples", "check_target", "atomic_path"],
)


@every_writer
class TestBadTargets:
    def test_missing_folder(self, tmp_path, write):
        with pytest.raises(
            gm.errors.FileError, match=r"no/file\.npz' cannot.*no' does not exist; create"
        ):
            write(tmp_path / "no" / "file.npz")
        assert litter(tmp_path) == []

    def test_a_file_as_folder(self, tmp_path, write):
        (tmp_path / "no").write_text("old")
        with pytest.raises(gm.errors.FileError, match="no' is not a folder; create"):
            write(tmp_path / "no" / "file.npz")
        with pytest.raises(gm.errors.FileError, match="deep' does not exist; create"):
            write(tmp_path / "no" / "deep" / "file.npz")
        assert (tmp_path / "no").read_text() == "old"

    def test_a_folder_as_file(self, tmp_path, write):
        (tmp_path / "file.npz").mkdir()
        with pytest.raises(gm.errors.FileError, match=r"file\.npz' is a folder; give the name"):
            write(tmp_path / "file.npz")
        assert litter(tmp_path) == ["file.npz"]

    def test_a_pipe(self, tmp_path, write):
        if not hasattr(os, "mkfifo"):
            pytest.skip("needs pipes")
        os.mkfifo(tmp_path / "file.npz")
        with pytest.raises(gm.errors.FileError, match="is a device or a pipe"):
            write(tmp_path / "file.npz")
        assert (tmp_path / "file.npz").is_fifo()

    def test_a_device_is_not_replaced(self, tmp_path, write):
        (tmp_path / "file.npz").symlink_to(os.devnull)
        with pytest.raises(gm.errors.FileError, match="is a device or a pipe"):
            write(tmp_path / "file.npz")
        assert stat.S_ISCHR(os.stat(os.devnull).st_mode)

    def test_a_protected_file(self, tmp_path, write, monkeypatch):
        (tmp_path / "file.npz").write_text("old")
        monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
        with pytest.raises(gm.errors.FileError, match=r"file\.npz' is write-protected; unprotect"):
            write(tmp_path / "file.npz")
        assert (tmp_path / "file.npz").read_text() == "old"
        assert litter(tmp_path) == ["file.npz"]

    def test_a_read_only_folder(self, read_only_folder, write):
        with pytest.raises(
            gm.errors.FileError, match="Permission denied; choose a folder that you may"
        ):
            write(read_only_folder / "file.npz")

    def test_a_folder_that_takes_no_files(self, write):
        if not os.path.isdir("/proc/self"):
            pytest.skip("needs /proc")
        with pytest.raises(
            gm.errors.FileError, match=r"'/proc/self/file\.npz' cannot be written: "
        ):
            write("/proc/self/file.npz")

    def test_too_long_a_name(self, tmp_path, write):
        with pytest.raises(gm.errors.FileError, match="cannot be written: File name too long"):
            write(tmp_path / ("n" * 300 + ".npz"))
        assert litter(tmp_path) == []

    def test_a_loop_of_links(self, tmp_path, write):
        (tmp_path / "file.npz").symlink_to(tmp_path / "file.npz")
        with pytest.raises(gm.errors.FileError, match="cannot be written: Too many levels"):
            write(tmp_path / "file.npz")
        assert litter(tmp_path) == ["file.npz"]


class TestCheckTarget:
    @every_suffix
    def test_good_targets_leave_no_trace(self, tmp_path, suffix):
        check(tmp_path / f"file{suffix.upper()}")
        assert litter(tmp_path) == []
        (tmp_path / f"file{suffix}").write_text("old")
        check(str(tmp_path / f"file{suffix}"))
        assert litter(tmp_path) == [f"file{suffix}"]
        assert (tmp_path / f"file{suffix}").read_text() == "old"

    def test_other_suffixes(self, tmp_path):
        check_target(tmp_path / "picture.png", (".png", ".svg"))
        with pytest.raises(gm.errors.UnknownNameError, match=r"use one of \.png, \.svg"):
            check_target(tmp_path / "picture.npz", (".png", ".svg"))

    def test_the_longest_name(self, tmp_path):
        name = "n" * 251 + ".npz"
        check(tmp_path / name)
        write_samples(make(), tmp_path / name)
        assert litter(tmp_path) == [name]


class TestReadErrors:
    @every_readable
    def test_missing(self, tmp_path, suffix):
        with pytest.raises(
            gm.errors.FileError, match=rf"file\{suffix}' cannot be read: No such file"
        ):
            read_samples(tmp_path / f"file{suffix}")

    @every_readable
    def test_a_folder(self, tmp_path, suffix):
        (tmp_path / f"file{suffix}").mkdir()
        with pytest.raises(
            gm.errors.FileError, match=rf"file\{suffix}' cannot be read: Is a directory"
        ):
            read_samples(tmp_path / f"file{suffix}")


def fail(path: Path, error: BaseException) -> None:
    """Write, then fail before the end."""
    before = os.listdir(path.parent)
    with atomic_path(path) as temporary:
        temporary.write_text("new")
        assert litter(path.parent, *before) == [temporary.name]
        raise error


class TestAtomicity:
    @every_suffix
    def test_an_old_file_is_replaced(self, tmp_path, suffix):
        path = tmp_path / f"file{suffix}"
        path.write_text("old")
        write_samples(make(), path)
        assert path.stat().st_size > 500
        assert litter(tmp_path) == [path.name]

    @every_suffix
    def test_a_full_disk(self, tmp_path, suffix):
        path = tmp_path / f"file{suffix}"
        path.write_text("old")
        pytest.importorskip("pyvista")  # before the limit: importing it writes files too
        message = rf"file\{suffix}' cannot.*File too large; make room"
        with pytest.raises(gm.errors.FileError, match=message), tiny_disk():
            write_samples(make(100), path)
        assert path.read_text() == "old"
        assert litter(tmp_path) == [path.name]

    @pytest.mark.parametrize("old", [True, False])
    @pytest.mark.parametrize(
        "error", [KeyboardInterrupt, SystemExit, ValueError, MemoryError, gm.errors.InputError]
    )
    def test_failure_inside(self, tmp_path, old, error):
        path = tmp_path / "picture.png"
        if old:
            path.write_text("old")
        with pytest.raises(error):
            fail(path, error("stop"))
        assert litter(tmp_path) == (["picture.png"] if old else [])
        assert not old or path.read_text() == "old"

    @pytest.mark.parametrize(
        ("code", "hint"),
        [
            (errno.ENOSPC, "No space left on device; make room or choose another disk"),
            (errno.EROFS, "Read-only file system; choose a folder that you may write to"),
            (errno.EIO, "Input/output error; choose another place"),
        ],
    )
    def test_disk_errors_inside(self, tmp_path, code, hint):
        path = tmp_path / "picture.png"
        with pytest.raises(gm.errors.FileError) as caught:
            fail(path, OSError(code, os.strerror(code)))
        assert str(caught.value) == f"'{path}' cannot be written: {hint}."
        assert isinstance(caught.value.__cause__, OSError)
        assert litter(tmp_path) == []

    def test_errors_of_our_own_pass(self, tmp_path):
        error = gm.errors.FileError("about another file")
        with pytest.raises(gm.errors.FileError) as caught, atomic_path(tmp_path / "picture.png"):
            raise error
        assert caught.value is error

    def test_failure_to_replace(self, tmp_path, monkeypatch):
        path = tmp_path / "file.npz"
        path.write_text("old")

        def refuse(*_: object) -> None:
            raise PermissionError(errno.EACCES, "Permission denied")

        monkeypatch.setattr(os, "replace", refuse)
        with pytest.raises(
            gm.errors.FileError, match=r"file\.npz' cannot be written: Permission denied"
        ):
            write_samples(make(), path)
        assert path.read_text() == "old"
        assert litter(tmp_path) == ["file.npz"]

    def test_a_block_that_writes_nothing(self, tmp_path):
        (tmp_path / "file.txt").write_text("old")
        with (
            pytest.raises(gm.errors.FileError, match="No such file"),
            atomic_path(tmp_path / "file.txt"),
        ):
            pass
        assert (tmp_path / "file.txt").read_text() == "old"

    def test_the_temporary_path(self, tmp_path):
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

    def test_the_old_file_stands_until_the_end(self, tmp_path):
        path = tmp_path / "file.txt"
        path.write_text("old")
        with atomic_path(path) as temporary:
            temporary.write_text("new")
            assert path.read_text() == "old"
        assert path.read_text() == "new"


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX permissions and links")
class TestPermissionsAndLinks:
    @every_suffix
    @pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
    def test_new_files_follow_the_umask(self, tmp_path, suffix, mask):
        before = os.umask(mask)
        try:
            write_samples(make(), tmp_path / f"file{suffix}")
        finally:
            os.umask(before)
        assert stat.S_IMODE((tmp_path / f"file{suffix}").stat().st_mode) == 0o666 & ~mask

    @pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
    def test_old_files_keep_theirs(self, tmp_path, mode):
        path = tmp_path / "file.npz"
        path.write_text("old")
        path.chmod(mode)
        write_samples(make(), path)
        assert stat.S_IMODE(path.stat().st_mode) == mode
        assert len(read_samples(path)) == 12

    @pytest.mark.parametrize("exists", [True, False])
    def test_links_are_followed(self, tmp_path, exists):
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

    def test_a_link_into_a_missing_folder(self, tmp_path):
        (tmp_path / "link.npz").symlink_to(tmp_path / "no" / "file.npz")
        with pytest.raises(gm.errors.FileError, match=r"link\.npz' cannot.*no' does not exist"):
            write_samples(make(), tmp_path / "link.npz")


class TestExtras:
    @every_suffix
    def test_no_format_needs_another_library(self, tmp_path, monkeypatch, suffix):
        pyarrow.array(np.zeros(1))  # now pyarrow looks for pandas, and only once
        for library in ("pyvista", "vtkmodules", "trimesh", "meshio", "pandas"):
            monkeypatch.setitem(sys.modules, library, None)
        write_samples(make(), tmp_path / f"file{suffix}")
        assert (tmp_path / f"file{suffix}").stat().st_size > 500

    def test_heavy_modules_are_imported_late(self):
        code = (
            "import sys, gaussmap.tools.files.formats\n"
            "print(sorted({'trimesh', 'pyvista', 'vtkmodules', 'sympy'} & sys.modules.keys()))"
        )
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert (run.stdout, run.stderr) == ("[]\n", "")


def test_an_interruption_leaves_the_older_file(tmp_path, monkeypatch, capsys, main):
    def half(samples: gm.Samples, path: Path) -> None:
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(formats.OF_SAMPLES, ".npz", formats.Format(half))
    Path("a.npz").write_text("old")
    assert main(["sample", "torus", "--count", "60", "--cells", "8", "8", "-o", "a.npz"]) == 130
    assert capsys.readouterr() == ("", "gaussmap: interrupted\n")
    assert [path.read_text() for path in Path().iterdir()] == ["old"]


def test_every_error_is_a_gaussmap_error():
    for error in (
        gm.errors.FileError,
        gm.errors.InputError,
        gm.errors.MissingExtraError,
        gm.errors.UnknownNameError,
    ):
        assert issubclass(error, gm.GaussmapError)
