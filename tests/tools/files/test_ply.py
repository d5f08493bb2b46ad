"""Headers of .ply files that gaussmap did not write, some of them in order to harm."""

from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused

POINTS = ["property float x", "property float y", "property float z"]
FIELDS = "comment gaussmap fields points"


def write(path: Path, *lines: str, body: bytes = b"", end: str = "\n") -> None:
    header = ["ply", "format binary_little_endian 1.0", *lines, "end_header", ""]
    path.write_bytes(end.join(header).encode() + body)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_line_ends(tmp_path, end):
    body = np.arange(6, dtype="<f4").tobytes()
    write(tmp_path / "a.ply", FIELDS, "element vertex 2", *POINTS, body=body, end=end)
    read = gm.read_samples(tmp_path / "a.ply")
    assert read.points.dtype == np.float32
    assert read.points.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_whole_numbers_are_widened(tmp_path):
    kinds = ["property short x", "property uint8 y", "property int32 z"]
    row = np.array([(-7, 200, 1 << 30)], "<i2,u1,<i4")
    write(tmp_path / "a.ply", FIELDS, "element vertex 1", *kinds, body=row.tobytes())
    read = gm.read_samples(tmp_path / "a.ply").points
    assert read.dtype == np.float64
    assert read.tolist() == [[-7, 200, 1 << 30]]


def test_elements_behind_the_vertices_are_left_out(tmp_path):
    others = ["element face 1", "property list uchar int vertex_index", "element edge 0"]
    write(tmp_path / "a.ply", FIELDS, "element vertex 1", *POINTS, *others, body=bytes(12 + 13))
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
    write(tmp_path / "a.ply", FIELDS, *lines)
    said = refused(message, gm.read_samples, tmp_path / "a.ply", error=gm.errors.FileError)
    assert len(said) < 1000


def test_the_format_comes_first(tmp_path):
    write(tmp_path / "a.ply", FIELDS, "element vertex 1", *POINTS, body=bytes(12))
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
