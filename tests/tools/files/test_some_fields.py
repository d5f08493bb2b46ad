"""Files of some of the fields that samples hold."""

from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest


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
