"""`read_cad` as a whole, with the process that reads: what users get of a file."""

# pyright: reportMissingImports=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from .shapes import box

SIZES = (50.8, 25.4, 76.2)


def test_a_part_is_read(tmp_path, write, capfd):
    path = write(box(*SIZES), "box.step", "INCH")
    capfd.readouterr()
    part = gm.read_cad(path)
    assert capfd.readouterr() == ("", "")
    assert (part.name, part.unit, part.oriented, len(part.solids)) == ("box.step", "in", True, 1)
    assert [x.kind for x in part.faces] == 6 * ["plane"]
    assert part.area == pytest.approx(22.0)
    part.save(tmp_path / "box.npz")
    again = gm.read_part(tmp_path / "box.npz")
    for name, array in part.arrays.items():
        np.testing.assert_array_equal(array, again.arrays[name])


def test_failed_faces_are_a_warning(tmp_path, write):
    path = tmp_path / "bö\udcffx.step"  # a name that is not UTF-8
    write(box(*SIZES), "box.step", "INCH").rename(path)
    text = path.read_text()
    path.write_text(text.replace("ADVANCED_FACE('',(#", "ADVANCED_FACE('lid',(#99999", 1))
    with pytest.warns(
        gm.GaussmapWarning, match=r"1 of 6 faces of .* cannot be used: face 5 \(lid\)"
    ):
        part = gm.read_cad(path, unit="mm")
    assert [x.name for x in part.failed] == ["lid"]
    assert part.unit == "mm"


def test_files_have_any_name_and_are_only_read(tmp_path, write, monkeypatch, capfd, main):
    folder = tmp_path / "Teile und Stücke"
    folder.mkdir()
    write(box(*SIZES), "box.step").rename(folder / "große Kiste.stp")
    (folder / "link").symlink_to(folder / "große Kiste.stp")
    monkeypatch.chdir(folder)
    folder.chmod(0o500)
    capfd.readouterr()
    assert main(["faces", "link"]) == 0
    assert len(capfd.readouterr().out.splitlines()) == 6
    out = tmp_path / "points.ply"
    assert main(["sample", "große Kiste.stp", "--count", "50", "-o", str(out)]) == 0
    assert np.isfinite(gm.read_samples(out).points).all()
    assert len(gm.read_cad("link")) == 6
    assert sorted(x.name for x in folder.iterdir()) == ["große Kiste.stp", "link"]
    folder.chmod(0o700)
