"""The page of `samples.view`: what it holds, and what is refused."""

import base64
import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.viewer import view as module

from ...refusals import refused


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    normals = gm.icosphere(4)
    without_circles = normals[np.abs(normals[:, 2]) < 0.99]
    return gm.sample("torus", normals=without_circles, cells=(16, 16), on="spline")


def read_page(text: str) -> dict[str, Any]:
    """Return the data of a page, with arrays (k,) in place of their texts."""
    found = re.search(r'<script type="application/json"[^>]*>(.*?)</script>', text, re.DOTALL)
    data = json.loads(found[1])
    kinds = dict.fromkeys(("points", "normals", "vertices", "edges"), "<f4")
    kinds |= {"kind": "u1", "prescribed": "u1"}
    kinds |= dict.fromkeys(("neighbours", "triangles", "of_triangles", "of_samples"), "<i4")
    for holder in (data, data.get("part") or {}):
        for name in {*holder} & {*kinds}:
            holder[name] = np.frombuffer(base64.b64decode(holder[name]), kinds[name])
    return data


def test_what_the_page_holds_is_that_of_the_samples(samples: gm.Samples) -> None:
    data = read_page(module.page(samples))
    points = data["points"].reshape(-1, 3) * data["diameter"] + data["centre"]
    np.testing.assert_allclose(points, samples.points, atol=1e-6)
    np.testing.assert_allclose(data["normals"].reshape(-1, 3), samples.normals, atol=1e-7)
    assert set(data["prescribed"]) == {1}
    kinds = np.where(samples.parabolic, 2, samples.hyperbolic)
    np.testing.assert_array_equal(data["kind"], kinds)
    others = data["neighbours"].reshape(len(samples), -1)
    apart = np.linalg.norm(samples.points[:, None] - samples.points, axis=-1)
    np.fill_diagonal(apart, np.inf)
    nearest = np.sort(apart, axis=1)[:, : others.shape[1]]
    found = np.sort(np.take_along_axis(apart, others, axis=1), axis=1)
    np.testing.assert_allclose(found, nearest, atol=1e-12)


def test_the_page_shows_the_whole_surface(samples: gm.Samples) -> None:
    data = read_page(module.page(samples))
    triangles = data["triangles"].reshape(-1, 3)
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    counts = np.unique(sides, axis=0, return_counts=True)[1]
    assert set(counts) <= {1, 2}
    assert (counts == 1).mean() < 0.05  # at the seams, where vertices differ by rounding
    a, b, c = np.moveaxis(data["vertices"].reshape(-1, 3)[triangles], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 * data["diameter"] ** 2
    assert area == pytest.approx(4.0 * np.pi**2 * 0.35, rel=0.01)


def test_the_cap_is_as_wide_as_normals_are_apart(samples: gm.Samples) -> None:
    assert 15.0 < read_page(module.page(samples))["angle"] < 20.0
    few = read_page(module.page(gm.sample("torus", normals=gm.icosphere(1), cells=(8, 8))))
    dense = gm.directions.cap(gm.icosphere(128), axis=(1, 0, 1), angle=10)
    many = read_page(module.page(gm.sample("torus", normals=dense, cells=(16, 16))))
    assert (many["angle"], few["angle"]) == (1.0, 20.0)


def test_the_region_is_a_few_per_cent_of_a_sphere_at_first() -> None:
    sphere = gm.sample("sphere", 4000, density="uniform", cells=(16, 16))
    data = read_page(module.page(sphere))
    apart = np.linalg.norm(sphere.points - sphere.points[0], axis=1) / data["diameter"]
    assert 0.02 < np.mean(apart < data["radius"] / 100.0) < 0.05


def test_faces_of_a_part_have_colours_labels_and_edges(parts: ModuleType) -> None:
    part = parts.all_kinds().select(kind=("plane", "cylinder", "sphere"))
    samples = gm.sample(part, 100)
    data = read_page(module.page(samples))
    found = data["part"]
    faces = found["of_triangles"]
    np.testing.assert_array_equal(found["of_samples"], samples.face_index)
    assert len(faces) == len(data["triangles"]) // 3
    cylinder = next(x for x in part.faces if x.kind == "cylinder")
    assert found["labels"][cylinder.index] == "Face 1: cylinder, radius 1 mm"
    corners = data["vertices"].reshape(-1, 3)[data["triangles"].reshape(-1, 3)].astype(np.float64)
    a, b, c = np.moveaxis(corners * data["diameter"] + data["centre"], 1, 0)
    normals = np.cross(b - a, c - a)
    areas = np.bincount(faces, np.linalg.norm(normals, axis=1) / 2)
    np.testing.assert_allclose(areas[:2], [x.area for x in part.faces[:2]], rtol=0.01)
    outward = (a + b + c)[faces == cylinder.index] / 3 * [1.0, 1.0, 0.0]
    assert (np.einsum("kx,kx->k", outward, normals[faces == cylinder.index]) > 0).all()
    assert {re.sub("[0-9a-f]", "", x) for x in found["colours"]} == {"#"}
    part.about["unit"] = ""
    assert read_page(module.page(gm.sample(part, 20)))["part"]["labels"][1] == (
        "Face 1: cylinder, radius 1"
    )
    edges = found["edges"].reshape(-1, 3)
    assert np.isnan(edges).any(axis=1).sum() >= len(part)
    assert np.nanmax(np.abs(edges)) <= 0.5 + 1e-6


def test_samples_above_flat_parts_are_in_the_range_of_the_axes(parts: ModuleType) -> None:
    data = read_page(module.page(gm.sample(parts.box(1.0, 30.0, 20.0), 100)))
    lifted = data["points"] + 0.012 * data["normals"]  # as scene.js does
    assert (np.abs(lifted.reshape(-1, 3)) <= np.array(data["range"])[:, 1]).all()


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


def test_the_command(tmp_path, capsys, main, parts):
    path = tmp_path / "part.html"
    parts.box().save(tmp_path / "part.npz")
    assert main(["view", str(tmp_path / "part.npz"), "--count", "60", "-o", str(path)]) == 0
    assert path.stat().st_size > 4_000_000
    assert "60 samples" in capsys.readouterr().out
    assert main(["view", "torus", "--count", "60000", "-o", str(tmp_path / "x.html")]) == 2
    assert "at most 50,000 samples, not 60,000" in capsys.readouterr().err
    assert not (tmp_path / "x.html").exists()


def test_what_is_refused(samples, tmp_path, monkeypatch):
    refused(r"\.html", samples.view, tmp_path / "torus.png", error=gm.errors.UnknownNameError)
    refused("no samples to view", samples[:0].view, tmp_path / "none.html")
    with pytest.raises(gm.errors.InputError, match=r"at most 50,000 samples, not 64,000"):
        samples[np.arange(len(samples)).repeat(200)].view(tmp_path / "many.html")
    monkeypatch.setitem(sys.modules, "plotly", None)
    with pytest.raises(gm.errors.MissingExtraError, match=r"gaussmap\[view\]"):
        samples.view(tmp_path / "torus.html")
    assert not list(tmp_path.iterdir())


def test_a_name_that_cannot_be_encoded(samples: gm.Samples, tmp_path: Path) -> None:
    named = replace(samples, report=replace(samples.report, surface="a\udc80\x1b"))
    named.view(tmp_path / "a.html")
    assert r"<title>a\udc80\x1b</title>" in (tmp_path / "a.html").read_text(encoding="utf-8")


def test_the_page_says_how_heights_are_drawn(samples: gm.Samples) -> None:
    flat = gm.surfaces.wavy_graph().transformed(np.diag([1.0, 1.0, 0.1]))
    page = module.page(gm.sample(flat, 50, cells=(8, 8)))
    assert "<h2>Surface (heights exaggerated 10 times)</h2>" in page
    assert "<h2>Surface</h2>" in module.page(samples)


def test_the_legend_has_the_colours_of_the_points(samples: gm.Samples) -> None:
    page = module.page(samples)
    colours = read_page(page)["pale"]
    dots = re.findall(r'class="dot" style="background:([^"]*)"></span>(\w+)', page)
    assert dots == [(colours[0], "elliptic"), (colours[1], "hyperbolic")]
