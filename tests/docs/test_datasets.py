"""The page of data sets says what the files hold, and its examples run."""

import importlib.util
import re
from pathlib import Path

import gaussmap as gm
import pytest
from gaussmap.runtime.samples.fields import COLUMNS, EDGE_NAMES, FLOAT_NAMES, PROVED_NAMES, UNITS
from gaussmap.tools.batch.folder import Settings, opened
from gaussmap.tools.batch.manifest import COLUMNS as MANIFEST
from gaussmap.tools.batch.manifest import ManifestRow, manifest_schema
from gaussmap.tools.batch.part_files import points_schema, write_manifest, write_part

PAGE = (Path(__file__).parents[2] / "docs" / "datasets.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
FIELDS = tuple(name for name in COLUMNS if name not in EDGE_NAMES)


def test_the_columns_of_points():
    schema = points_schema(Settings.of_this_version({}, FIELDS))
    lines = ["| part | | int64 | | never |"]
    for name in FIELDS:
        field = schema.field(COLUMNS[name][0])
        kind = {"double": "real"}.get(str(field.type), str(field.type))
        cells = [", ".join(COLUMNS[name]), name, kind, UNITS.get(name, ""),
                 "without the field" if field.nullable else "never"]  # fmt: skip
        lines.append(re.sub("  +", " ", f"| {' | '.join(cells)} |"))
    assert "\n".join(lines) in PAGE
    assert [*re.findall(r"^\| \w.*? \| (\w+) \| real", PAGE, re.MULTILINE)] == [
        *FLOAT_NAMES,
        *PROVED_NAMES,
    ]


def test_the_columns_of_the_manifest():
    lines = []
    for field in manifest_schema():
        known = MANIFEST[field.name].metadata
        cells = [field.name, str(field.type), known.get("unit", ""),
                 "if unknown" if field.nullable else "never", known["meaning"]]  # fmt: skip
        lines.append(re.sub("  +", " ", f"| {' | '.join(cells)} |").replace("double", "float64"))
    assert "\n".join(lines) in PAGE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write the data set of the page without other processes."""
    samples = list(
        gm.sample_many(["torus", "sphere", "ellipsoid"], 500, cells=(16, 16), fields=FLOAT_NAMES)
    )
    settings, out = Settings.of_this_version(asked={}, fields=FLOAT_NAMES), tmp_path / "dataset"
    with opened(out, settings):
        for k, part in enumerate(samples):
            row = ManifestRow(k, part.report.surface, "catalogue", "0", samples=len(part))
            write_part(out, settings, row, part)
        write_manifest(out, settings, range(len(samples)))
    return tmp_path


def run(blocks: list[str]) -> dict[str, object]:
    known: dict[str, object] = {"__name__": "__main__"}
    for source in blocks:
        if "import torch" in source and importlib.util.find_spec("torch") is None:
            continue
        exec(compile(source, "datasets.md", "exec"), known)
    return known


def check(known: dict[str, object]) -> None:
    samples, by_name, one, rows = (known[x] for x in ("samples", "by_name", "one", "rows"))
    assert isinstance(samples, gm.Samples)
    assert isinstance(rows, list)
    assert len(samples) == len(one) == 500  # pyright: ignore[reportArgumentType]
    assert dict(by_name.iter_rows()) == {"torus": 500, "sphere": 500, "ellipsoid": 500}  # pyright: ignore[reportAttributeAccessIssue]
    assert [(name, count) for name, count, _ in rows] == [
        ("ellipsoid", 500), ("sphere", 500), ("torus", 500)
    ]  # fmt: skip
    assert rows[1][2] == pytest.approx(1.0, rel=1e-2)  # K of the unit sphere


def test_examples(folder, monkeypatch, capsys):
    for name in ("duckdb", "pandas", "polars"):
        pytest.importorskip(name)
    monkeypatch.chdir(folder)
    check(run(BLOCKS[1:]))
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] in BLOCKS[1]
    assert printed[1] == "3 (256, 3) (256, 3) 2 1"


def test_all_examples(tmp_path, monkeypatch):
    for name in ("duckdb", "pandas", "polars", "cloudpickle"):
        pytest.importorskip(name)
    monkeypatch.chdir(tmp_path)
    check(run(BLOCKS))
