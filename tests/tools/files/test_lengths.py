"""Units of length, and their names."""

import pytest
from gaussmap.tools.files.lengths import METRES, unit_named


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("MM", "mm"),
        (" millimetre", "mm"),
        ("INCH", "in"),
        ("Foot", "ft"),
        ("US survey foot", "us-ft"),
        ("ell", None),
    ],
)
def test_units_have_several_names(name, unit):
    assert unit_named(name) == unit


def test_lengths_are_those_of_the_standards():
    assert METRES["in"] == 0.0254
    assert METRES["ft"] == pytest.approx(12 * METRES["in"])
    assert METRES["mi"] == pytest.approx(5280 * METRES["ft"])
