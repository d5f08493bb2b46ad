"""The page of `samples.view`: what it holds, and what is refused."""

import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.viewer import view as module

pytest.importorskip("plotly")
pytestmark = pytest.mark.compiled


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    return gm.sample("torus", normals=gm.icosphere(4), cells=(16, 16))


def test_the_page_loads_nothing(samples: gm.Samples) -> None:
    text = module.page(samples)
    own = text[: text.index("<script>")] + text[text.index('<script type="application/json"') :]
    assert not re.search(r"https?://|//cdn|@import|url\(", own)
    assert "<link" not in own
    assert not re.search(r"<(script|img|iframe)[^>]* src=", text)
    assert "320 samples" in own


def test_text_of_users_is_text(samples: gm.Samples) -> None:
    surface = gm.Surface.from_sympy(
        ("u", "v", "u*v"), ("u", "v"), ((-1, 1), (-1, 1)), name="<script>alert(1)</script>&"
    )
    text = module.page(gm.sample(surface, 50, cells=(8, 8)))
    assert "<h1>&lt;script&gt;alert(1)&lt;/script&gt;&amp;</h1>" in text
    assert "<script>alert" not in text


def test_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], main: Callable[..., int], parts: ModuleType
) -> None:
    path = tmp_path / "part.html"
    parts.box().save(tmp_path / "part.npz")
    assert main(["view", str(tmp_path / "part.npz"), "--count", "60", "-o", str(path)]) == 0
    assert path.stat().st_size > 4_000_000
    assert "60 samples" in capsys.readouterr().out
    assert main(["view", "torus", "--count", "60000", "-o", str(tmp_path / "x.html")]) == 2
    assert "at most 50,000 samples, not 60,000" in capsys.readouterr().err
    assert not (tmp_path / "x.html").exists()


def test_what_is_refused(
    samples: gm.Samples, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(gm.errors.UnknownNameError, match=r"\.html"):
        samples.view(tmp_path / "torus.png")
    with pytest.raises(gm.errors.InputError, match="no samples to view"):
        samples[:0].view(tmp_path / "none.html")
    with pytest.raises(gm.errors.InputError, match=r"at most 50,000 samples, not 64,000"):
        samples[np.arange(len(samples)).repeat(200)].view(tmp_path / "many.html")
    monkeypatch.setitem(sys.modules, "plotly", None)
    with pytest.raises(gm.errors.MissingExtraError, match=r"gaussmap\[view\]"):
        samples.view(tmp_path / "torus.html")
    assert not list(tmp_path.iterdir())
