"""Files before they are read: their formats, and whether they are whole."""

import pytest
from gaussmap.tools.cad.inspection import BadFileError, checked_format

STEP = b"""ISO-10303-21;
HEADER;
FILE_NAME('a (nan) part','',(''),(''),'','','');
ENDSEC;
DATA;
#1=CLOSED_SHELL('',(#2,#3));
#2=ADVANCED_FACE('top',(#4),#5,.T.);
#3=ADVANCED_FACE('',(#6),#5,.T.);
#4=FACE_BOUND('',#7,.T.);
#5=PLANE('a;#99',#8);
#6=FACE_BOUND('',#9,.T.);
#7=POINT('',(1.,2.));
#8=POINT('',(0.,0.));
#9=POINT('',(3.,4.E+20)); /* #98 */
ENDSEC;
END-ISO-10303-21;
"""
BREP = b"""DBRep_DrawableShape

CASCADE Topology V1
TShapes 2
Ve
1e-07
0 0 0
*
So
+2 0 *

+1 0
"""


def iges(lines=(("S", 1), ("G", 1), ("D", 2), ("P", 1)), end=True) -> bytes:
    rows = [f"{letter.lower() * 5:72}{letter}{k + 1:7}" for letter, n in lines for k in range(n)]
    counts = "".join(f"{letter}{n:7}" for letter, n in lines)
    return "\n".join([*rows, *([f"{counts:72}T{1:7}"] if end else [])]).encode()


@pytest.mark.parametrize(
    ("content", "form"), [(STEP, "STEP"), (BREP, "BREP"), (BREP + b"0\n", "BREP"), (iges(), "IGES")]
)
def test_formats_are_known_by_their_content(content, form):
    assert checked_format(content) == form


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
        *(
            (STEP.replace(b"3.,4.", x + b",4."), "not finite")
            for x in (b"nan", b"-NaN", b"inf", b"1.E+400", b"2.5E999")
        ),
    ],
)
def test_what_is_wrong_is_one_sentence(content, reason):
    with pytest.raises(BadFileError, match=reason) as error:
        checked_format(content)
    assert str(error.value).count(". ") == 0


def test_texts_and_comments_are_no_numbers():
    assert checked_format(STEP.replace(b"#98", b"(nan, 1.)")) == "STEP"
