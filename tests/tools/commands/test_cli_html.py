"""The command `gaussmap formulas --html`: a page that is complete or not there."""

from __future__ import annotations

import os
import re
import sys
from functools import cache
from pathlib import Path

import gaussmap as gm
import pytest
from gaussmap.symbolic import html
from gaussmap.tools.commands.cli import main

pytest.importorskip("math_core")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def names() -> list[str]:
    return sorted(path.name for path in Path().iterdir())


@pytest.fixture
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that takes no time."""
    monkeypatch.setattr(html, "page", lambda: "μ\n")


@pytest.mark.slow
def test_the_page_is_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(html, "page", cache(html.page))  # it takes seconds
    assert main(["formulas", "--html", "formulas.html"]) == 0
    out, err = capsys.readouterr()
    count = len(gm.surfaces.names())
    assert out == f"formulas.html: {len(gm.formulas)} formulas and {count} surfaces\n"
    assert err == ""
    assert Path("formulas.html").read_bytes() == html.page().encode()
    assert names() == ["formulas.html"]


@pytest.mark.usefixtures("_short")
@pytest.mark.parametrize("name", ["a.html", "A.HTML", "a b.html", "ä.html", "folder/a.html"])
def test_names_of_files(name: str) -> None:
    Path("folder").mkdir()
    assert main(["formulas", "--html", name]) == 0
    assert Path(name).read_bytes() == "μ\n".encode()


@pytest.mark.usefixtures("_short")
def test_an_older_page_is_replaced() -> None:
    Path("a.html").write_text("old")
    Path("link.html").symlink_to("a.html")
    assert main(["formulas", "--html", "link.html"]) == 0
    assert Path("a.html").read_text(encoding="utf-8") == "μ\n"
    assert Path("link.html").is_symlink()
    assert names() == ["a.html", "link.html"]


@pytest.mark.usefixtures("_short")
def test_what_cannot_be_finished_is_not_begun(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    Path("a.html").write_text("old")
    monkeypatch.setattr(os, "replace", full)
    assert main(["formulas", "--html", "a.html"]) == 2
    err = capsys.readouterr().err
    assert re.fullmatch(r"gaussmap: error: 'a\.html' cannot be written: No space left.*\n", err)
    assert Path("a.html").read_text() == "old"
    assert names() == ["a.html"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--html", "a.pdf"], r"'a\.pdf' has the suffix '\.pdf'; use one of \.html"),
        (["--html", "a"], "'a' has no suffix; use one of .html"),
        (["--html", ""], "the name of the file is empty"),
        (["--html", "missing/a.html"], "'.*missing' does not exist"),
        (["--html", "file.html/a.html"], "is not a folder"),
        (["--html", "folder.html"], "'folder.html' is a folder"),
        (["--html"], "option '--html' requires an argument"),
        (["--html", "a.html", "--latex"], "--html is not allowed with --latex"),
        (["envelope", "--html", "a.html"], "--html writes all formulas"),
    ],
)
def test_an_error_is_one_line(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(html, "page", lambda: pytest.fail("worked in vain"))
    Path("folder.html").mkdir()
    Path("file.html").write_text("old")
    assert main(["formulas", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert re.fullmatch(r"gaussmap: error: [^\n]+\n", err)
    assert re.search(message, err)
    assert names() == ["file.html", "folder.html"]
    assert Path("file.html").read_text() == "old"


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_protected(capsys: pytest.CaptureFixture[str]) -> None:
    Path("folder").mkdir(mode=0o500)
    assert main(["formulas", "--html", "folder/a.html"]) == 2
    assert re.fullmatch(r"gaussmap: error: [^\n]+ cannot be [^\n]+\n", capsys.readouterr().err)


def test_without_the_extra(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "math_core", None)
    assert main(["formulas", "--html", "a.html"]) == 2
    err = capsys.readouterr().err
    assert re.fullmatch(r"gaussmap: error: [^\n]+math-core[^\n]+\"gaussmap\[html\]\"\n", err)
    assert names() == []
    # The other forms of the command need nothing.
    assert main(["formulas", "envelope", "--latex"]) == 0
