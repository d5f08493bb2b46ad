"""The page of data sets says what the files hold, and its examples run."""

import importlib.util
import re
from pathlib import Path
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.runtime.samples.fields import COLUMNS, EDGE_NAMES, FLOAT_NAMES, PROVED_NAMES, UNITS
from gaussmap.tools.batch.folder import Settings
from gaussmap.tools.batch.manifest import COLUMNS as MANIFEST
from gaussmap.tools.batch.manifest import manifest_schema
from gaussmap.tools.batch.part_files import points_schema

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


def test_examples(tmp_path, monkeypatch, capsys):
    for name in ("duckdb", "pandas", "polars", "cloudpickle"):
        pytest.importorskip(name)
    monkeypatch.chdir(tmp_path)
    known: dict[str, Any] = {"__name__": "__main__"}
    for source in BLOCKS:
        if "import torch" not in source or importlib.util.find_spec("torch"):
            exec(compile(source, "datasets.md", "exec"), known)
    assert isinstance(known["samples"], gm.Samples)
    assert len(known["samples"]) == len(known["one"]) == 500
    counts = {"ellipsoid": 500, "sphere": 500, "torus": 500}
    assert dict(known["by_name"].iter_rows()) == counts
    assert [(name, count) for name, count, _ in known["rows"]] == [*counts.items()]
    assert known["rows"][1][2] == pytest.approx(1.0, rel=1e-2)  # K of the unit sphere
    printed = [x for x in capsys.readouterr().out.splitlines() if x]
    assert any(x in BLOCKS[1] for x in printed)
    assert "3 (256, 3) (256, 3) 2 1" in printed
