"""The number of faces that a file says it has."""

import pytest
from gaussmap.tools.cad.inspection import faces_said

STEP = b"""#1 = CLOSED_SHELL('a',(#2,#3,
  #4)); #5 = OPEN_SHELL ( '' , ( #4 ) );
#6 = ORIENTED_CLOSED_SHELL('',*,#1,.F.);"""
IGES = "\n".join(
    f"{kind:8}{more:64}D{number:7}"
    for number, (kind, more) in enumerate(
        [(144, ""), (144, "label"), (128, ""), (128, ""), (510, "144"), (510, "")], 1
    )
).encode()


@pytest.mark.parametrize(
    ("content", "form", "count"), [(STEP, "STEP", 3), (IGES, "IGES", 2), (STEP, "BREP", 0)]
)
def test_faces_are_counted_once(content, form, count):
    assert faces_said(content, form) == count
