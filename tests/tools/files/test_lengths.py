"""Units of length, and their names."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.files.lengths import METRES, unit_named


@pytest.mark.parametrize(
    ("name", "unit"),
    [("MM", "mm"), (" millimetre", "mm"), ("INCH", "in"), ("Foot", "ft"),
     ("US survey foot", "us-ft"), ("ell", None)],
)  # fmt: skip
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


def header(samples, folder):
    samples.write(folder / "a.csv")
    return (folder / "a.csv").read_text().partition("\n")[0].split(",")


def terrain(crs):
    x = np.arange(12.0)
    return gm.terrain(np.sin(x)[:, None] * np.cos(x), spacing=(1.0, 1.0), crs=crs)


def test_tables_of_parts_name_the_unit(tmp_path):
    part = gm.read_part(f"{gm.__path__[0]}/docs/gallery/bracket.npz")
    samples = gm.sample(part, 40)
    names = header(samples, tmp_path)
    assert names[:4] == ["x [mm]", "y [mm]", "z [mm]", "nx"]
    assert {"support [mm]", "gaussian_curvature [1/mm^2]", "mean_curvature [1/mm]"} <= {*names}
    parquet = pytest.importorskip("pyarrow.parquet")
    samples.write(tmp_path / "a.parquet")
    schema = parquet.read_schema(tmp_path / "a.parquet")
    assert schema.metadata[b"unit_of_length"] == b"mm"
    assert schema.field("x").metadata[b"unit"] == b"mm"
    assert schema.field("gaussian_curvature").metadata[b"unit"] == b"1/mm^2"
    assert schema.field("nx").metadata[b"unit"] == b"1"


@pytest.mark.parametrize(("crs", "name"), [("EPSG:32617", "x [m]"), ("EPSG:2263", "x [us-ft]")])
def test_terrain_has_the_unit_of_its_reference_system(crs, name, tmp_path):
    samples, unit = gm.sample(terrain(crs), 20), name[3:-1]
    assert header(samples, tmp_path)[0] == name
    report = samples.report
    assert report.unit == unit
    misfit = f"within {report.fit_distance:.3g} {unit} of the data (root mean square "
    assert f"{misfit}{report.fit_rms:.3g} {unit})" in samples.summary()


def test_no_unit_is_named_that_is_not_known(tmp_path):
    for surface in ("torus", terrain(None)):
        samples = gm.sample(surface, 20)
        assert header(samples, tmp_path)[:3] == ["x", "y", "z"]
        parquet = pytest.importorskip("pyarrow.parquet")
        samples.write(tmp_path / "a.parquet")
        assert b"unit_of_length" not in parquet.read_schema(tmp_path / "a.parquet").metadata
