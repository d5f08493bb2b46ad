"""Files before they are read: formats, how many faces they say, whether they are whole, damage."""

from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.damaged_step import without_damaged_faces
from gaussmap.tools.cad.examples import all_kinds, box_edges, box_faces
from gaussmap.tools.cad.inspection import UnusableError, checked_format, faces_said
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import NO_AREA, FaceRecord, Geometry
from gaussmap.tools.cad.source import prepared

from ...refusals import refused
from .made import AXES, FAILED, TURN, circle, face, part, placement

HERE = Path(__file__).parent
STEP, BREP = ((HERE / f"small.{x}").read_bytes() for x in ("step", "brep"))


def iges(lines=(("S", 1), ("G", 1), ("D", 2), ("P", 1)), end=True) -> bytes:
    rows = [f"{letter.lower() * 5:72}{letter}{k + 1:7}" for letter, n in lines for k in range(n)]
    counts = "".join(f"{letter}{n:7}" for letter, n in lines)
    return "\n".join([*rows, *([f"{counts:72}T{1:7}"] if end else [])]).encode()


@pytest.mark.parametrize(
    ("content", "form"), [(STEP, "STEP"), (BREP, "BREP"), (BREP + b"0\n", "BREP"), (iges(), "IGES")]
)
def test_formats_are_known_by_their_content(content, form):
    assert checked_format(content) == (form, True)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b" \n", "is empty"),
        (b"hello\n" * 50, "is not a STEP, IGES or BREP file"),
        (bytes(range(256)) * 20, "is not a STEP, IGES or BREP file"),
        (STEP[:300], "is truncated"),
        (BREP[:-8], "is truncated"),
        (BREP.replace(b"TShapes 2", b"TShapes 3"), "is truncated"),
        (BREP.replace(b"0 0 0", b"0 nan 0"), "not finite"),
        (iges(end=False), "is truncated"),
        (iges().replace(b"D      2P", b"D      4P"), "is damaged: its last line says 4 lines"),
        (iges().replace(b"ppppp", b",NaN,"), "not finite"),
    ],
)
def test_what_is_wrong_is_one_sentence(content, reason):
    said = refused(reason, checked_format, content, error=UnusableError)
    assert said.count(". ") == 0


def test_texts_and_comments_are_no_numbers_and_no_references():
    assert checked_format(STEP) == ("STEP", True)
    assert without_damaged_faces(STEP, {})[1] == ()


@pytest.mark.parametrize("number", [b"nan", b"-NaN", b"inf", b"1.E+400", b"2.5E999"])
def test_a_face_with_numbers_that_are_not_finite_is_left_out(number):
    content = STEP.replace(b"3.,4.", number + b",4.")
    assert checked_format(content) == ("STEP", False)
    rest, lost = without_damaged_faces(content, {})
    assert [(x.name, x.reason) for x in lost] == [
        ("#3", "its #9 holds a number that is not finite")
    ]
    assert b"#1=CLOSED_SHELL('',(#2));" in rest
    assert without_damaged_faces(rest, {})[1] == ()


def test_a_number_that_is_not_finite_and_in_no_face_is_an_error():
    content = STEP.replace(b"ENDSEC;\nEND", b"#10=AXIS('',(nan));\nENDSEC;\nEND")
    refused("in #10", without_damaged_faces, content, {}, error=UnusableError)


def test_faces_that_refer_to_nothing_are_left_out():
    rest, lost = without_damaged_faces(STEP.replace(b"#4),#5", b"#77),#5"), {})
    assert [(x.name, x.reason) for x in lost] == [
        ("top", "its #2 refers to #77, which the file lacks")
    ]
    assert b"#1=CLOSED_SHELL('',(#3));" in rest
    rest, lost = without_damaged_faces(STEP.replace(b"(#2,#3)", b"(#2,#77)"), {})
    assert [(x.name, x.reason) for x in lost] == [("#77", "the file lacks it")]
    assert b"#1=CLOSED_SHELL('',(#2));" in rest


def test_both_faces_of_a_damaged_surface_are_left_out():
    rest, lost = without_damaged_faces(STEP, {8: "its #8 is damaged"})
    assert [x.name for x in lost] == ["top", "#3"]
    assert b"#1=CLOSED_SHELL('',());" in rest


def test_a_copy_is_made_of_files_with_damaged_faces_only(tmp_path):
    path = tmp_path / "part.step"
    path.write_bytes(STEP)
    assert prepared(path, tmp_path).path == path
    path.write_bytes(STEP.replace(b"3.,4.", b"nan,4."))
    source = prepared(path, tmp_path)
    assert source.path != path
    assert source.path.read_bytes() == source.content
    assert len(source.lost) == 1


SHELLS = b"""#1 = CLOSED_SHELL('a',(#2,#3,
  #4)); #5 = OPEN_SHELL ( '' , ( #4 ) );
#6 = ORIENTED_CLOSED_SHELL('',*,#1,.F.);"""
ENTITIES = [(144, ""), (144, "label"), (128, ""), (128, ""), (510, "144"), (510, "")]
IGES = "\n".join(f"{kind:8}{more:64}D{k:7}" for k, (kind, more) in enumerate(ENTITIES, 1)).encode()


@pytest.mark.parametrize(
    ("content", "form", "count"), [(SHELLS, "STEP", 3), (IGES, "IGES", 2), (SHELLS, "BREP", 0)]
)
def test_faces_are_counted_once(content, form, count):
    assert faces_said(content, form) == count


# --- bounds and volumes of parts ------------------------------------------------------------------


@pytest.fixture(scope="module")
def slanted() -> Part:
    """Return a cylinder of radius 1 that is cut off at z = 2 + x/2, seen in another frame."""
    x, _, z = AXES
    place, count = np.concatenate([np.zeros(3), AXES.ravel()]), 720
    u = np.linspace(0.0, TURN, count)
    border = np.concatenate([[(0.0, 0.0), (TURN, 0.0)], np.stack([u, 2 + np.cos(u) / 2], 1)[::-1]])
    # u and v along the axes of the ellipse, the first of length 1/cos of its slope.
    slope, ends = np.sqrt(1.25), (-1.0, 1.0)
    top = placement(2 * z, (z - x / 2) / slope, (x + z / 2) / slope)
    ellipse, area = circle(1.0, count) * [slope, 1.0], np.pi
    return part([
        face("cylinder", 1.0, v=(0.0, 2.5), place=place, area=4 * np.pi, loops=[border]),
        face("plane", u=ends, v=ends, place=place, area=area, loops=[circle()], reversed=True),
        face("plane", u=(-slope, slope), v=ends, place=top, area=slope * area, loops=[ellipse]),
    ])  # fmt: skip


def test_volume_below_a_curved_border(slanted):
    """The polygon leaves the border by up to (2π / 720)² / 16."""
    assert slanted.volume == pytest.approx(2 * np.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("kind", "sizes", "volume"),
    [("sphere", [2.0], 32 * np.pi / 3), ("torus", [2.0, 0.5], np.pi**2)],
)
def test_volumes_of_closed_faces(kind, sizes, volume):
    closed = part([face(kind, *sizes, place=placement((5.0, 7.0, -3.0)))])
    assert closed.volume == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (all_kinds(), "its faces enclose no solids"),
        (part([*box_faces(), FAILED]), "some of its faces cannot be used"),
    ],
)
def test_volumes_that_are_not_known(given, reason):
    refused(reason, lambda: given.volume, error=gm.errors.SurfaceError)


def test_faces_of_no_area_and_open_sheets_do_not_count_in_volumes():
    nothing = FaceRecord(Geometry("unknown"), reason=NO_AREA)
    assert part([*box_faces(), nothing]).volume == pytest.approx(6.0)
    sheet = face("plane", place=placement((9.0, 0.0, 0.0)))
    mixed = part([*box_faces(), sheet, FAILED], oriented=False, edges=box_edges())
    with pytest.warns(gm.GaussmapWarning, match="2 faces of 8 belong to none"):
        assert mixed.volume == pytest.approx(6.0)
    alone, error = part([sheet], oriented=False), gm.errors.SurfaceError
    refused("enclose no solids", lambda: alone.volume, error=error)


def test_bounds_of_a_tilted_torus():
    """Largest inside the face: there is no border near it."""
    tilted = part([face("torus", 2.0, 0.5, place=[1.0, 2.0, 3.0, *AXES.ravel()])])
    extent = 2.0 * np.sqrt(1.0 - AXES[2] ** 2) + 0.5
    np.testing.assert_allclose(tilted.bounds - [1, 2, 3], [-extent, extent], atol=1e-12)


def test_bounds_at_a_border(slanted):
    x, y, z = AXES
    roof = 2 * z + np.hypot(x + z / 2, y)
    floor = np.hypot(x, y)
    low = np.minimum(2 * z - np.hypot(x + z / 2, y), -floor)
    np.testing.assert_allclose(slanted.bounds, [low, np.maximum(roof, floor)], atol=1e-5)
