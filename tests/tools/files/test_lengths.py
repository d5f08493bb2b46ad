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
    assert METRES["yd"] == pytest.approx(3 * METRES["ft"])
    assert METRES["mi"] == pytest.approx(5280 * METRES["ft"])
    assert METRES["mil"] == pytest.approx(METRES["in"] / 1_000)
    assert METRES["uin"] == pytest.approx(METRES["in"] / 1_000_000)
    assert METRES["us-ft"] * 3937 == pytest.approx(1200, rel=1e-15)
    assert METRES["ft"] / METRES["us-ft"] == pytest.approx(1 - 2e-6, rel=1e-12)
    metric = [METRES[x] for x in ("nm", "um", "mm", "cm", "dm", "m", "km")]
    assert metric == [1e-9, 1e-6, 1e-3, 1e-2, 1e-1, 1.0, 1e3]
