"""CAD parts on the command line."""

import csv
from dataclasses import replace

import gaussmap as gm
import pytest
from gaussmap.tools.cad.examples import box_faces

from .made import part


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("part.step", "ISO-10303-21;"),
        ("part.RLE", ""),
        ("part.txt", "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n"),
        ("part", "ISO-10303-21;"),
    ],
)
def test_without_open_cascade(tmp_path, capsys, monkeypatch, main, name, content):
    """Files of all suffixes are known; without the extra, the error says how to install it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(content)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["sample", name, "--count", "10", "-o", "out.ply"]) == 2
    assert 'pip install "gaussmap[cad]"' in capsys.readouterr().err


FORMULAS = '=HYPERLINK("x")', "+1", "-1", "@SUM(1)", "\t=1"


def test_names_are_no_formulas_of_spreadsheets(tmp_path, capsys, main, monkeypatch):
    """Names of faces come from files of others; escapes on a terminal, too."""
    monkeypatch.chdir(tmp_path)
    names = dict(zip(range(6), ["\x1b[2Jslot\n", *FORMULAS], strict=True))
    records = [replace(x, name=names[k]) for k, x in enumerate(box_faces())]
    whole = part(records)
    gm.sample(whole, 60).write("names.csv")
    with open("names.csv", newline="") as file:
        found = {row["face_name"] for row in csv.DictReader(file)}
    assert found == {names[0], *(f"'{x}" for x in FORMULAS)}
    whole.save("names.npz")
    assert main(["faces", "names.npz"]) == 0
    out = capsys.readouterr().out
    assert len(out.splitlines()) == 6
    assert r"\x1b[2Jslot" in out
    assert "\x1b" not in out
