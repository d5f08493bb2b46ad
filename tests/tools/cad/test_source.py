"""Assemblies in several STEP files: which part files are read, and why others are not."""

import os

import pytest
from gaussmap.tools.cad.source import prepared

ENDS = "ISO-10303-21;\nDATA;\n{}\nENDSEC;\nEND-ISO-10303-21;\n"
SHELL = "#10=ADVANCED_FACE('',(#12),#12,.T.);\n#11=OPEN_SHELL('',(#10));\n#12=X();"


def step(*names: str, assigned: str | None = None) -> bytes:
    """Return a STEP file that refers to files."""
    lines = [f"#{k} = DOCUMENT_FILE('{x}','',$,#9,'',$);" for k, x in enumerate(names, 20)]
    if assigned is not None:
        lines.append(f"#30=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{assigned}',#1,#2,(#20));")
    return ENDS.format("\n".join([SHELL, *lines])).encode()


@pytest.fixture
def read(tmp_path):
    """Write files, and prepare the first of them."""

    def read(**files: bytes):
        for name, content in files.items():
            (tmp_path / f"{name}.stp").write_bytes(content)
        (tmp_path / "out").mkdir()
        return prepared(tmp_path / f"{next(iter(files))}.stp", tmp_path / "out")

    return read


def test_part_files_of_all_levels_are_copied_and_renamed(read, tmp_path):
    source = read(top=step("a.stp"), a=step("b.stp"), b=step())
    assert (source.parts.unreadable, source.faces_said()) == ({}, 3)
    copies = sorted((tmp_path / "out").iterdir())
    assert len(copies) == 3
    assert copies[0].name.encode() in source.content.replace(b"-1-", b"-0-")
    assert not any(b"'a.stp'" in x.read_bytes() or b"'b.stp'" in x.read_bytes() for x in copies)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "does not exist"),
        (b"", "is empty"),
        (b"version https://git-lfs.github.com/spec/v1", "is a Git LFS pointer"),
        (b"hello\n" * 9, "is not a STEP, IGES or BREP file"),
        (step()[:-30], "is truncated"),
        (step("top.stp"), None),
    ],
)
def test_part_files_that_cannot_be_read_are_named(content, reason, read, tmp_path):
    files = {} if content is None else {"b": content}
    source = read(top=step("a.stp", "drawing.pdf"), a=step("b.stp"), **files)
    name = "b.stp" if reason else "top.stp"
    assert list(source.parts.unreadable) == [name]
    assert source.parts.unreadable[name].startswith(reason or "refers to itself")
    assert name in source.parts.said()
    # Open CASCADE finds none in their place.
    assert len(list((tmp_path / "out").iterdir())) == (2 if reason else 3)


def test_pipes_are_not_waited_for(read, tmp_path):
    os.mkfifo(tmp_path / "a.stp")
    assert read(top=step("a.stp")).parts.said() == (
        "1 of 1 part file cannot be read: 'a.stp' is a device or a pipe; give the name of a file"
    )


def test_the_assigned_name_goes_before_that_of_the_document(read):
    source = read(top=step("no.stp", "b.stp", assigned="it''s.stp"), b=step(), **{"it's": step()})
    assert (source.parts.unreadable, source.faces_said()) == ({}, 3)


def test_names_of_part_files_are_decoded(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "gr\xf6n.stp").write_bytes(step())
    for name in ("gr\\X2\\00F6\\X0\\n.stp", "gr\\X\\F6n.stp", "gr\xf6n.stp"):
        (tmp_path / "top.stp").write_bytes(step(name))
        assert prepared(tmp_path / "top.stp", tmp_path / "out").faces_said() == 2
