"""The figures of the README are those of the pages in docs/."""

from pathlib import Path

from gaussmap.benchmarks.peers.forms import FORMS

from .pages import tables

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
MESH_OF = {
    "**balanced**": '**balanced**, prefer="normals"',
    "**aligned**": '**aligned**, prefer="normals"',
    "NumPy, (u,v) grid, closed form": "grid of parameters",
}


def of_quality(surface: int) -> list[dict[str, dict[str, str]]]:
    """Return the tables of a surface in docs/quality.md: cells by title and column."""
    page = (ROOT / "docs" / "quality.md").read_text(encoding="utf-8")
    section = page.split(f"## {FORMS[surface].label}\n")[1].split("\n## ")[0]
    return [
        {title: dict(zip(header[1:], cells, strict=True)) for title, *cells in rows}
        for header, *rows in tables(section)
    ]


def figures(title: str, surface: int) -> tuple[str, str, str, str]:
    """Return E, G, mean angle of the mesh and points/s of a row, from the pages in docs/."""
    points, meshes = of_quality(surface)
    mesh = meshes.get(MESH_OF.get(title, title), {"mean angle": "–"})["mean angle"]
    if title in points:
        E, G, rate = (points[title][x] for x in ("E", "G", "points/s"))
    else:
        page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
        compared = tables(page.split("## Compared with other packages")[1])[surface]
        rate, E, G = next([x[k] for k in (3, -2, -1)] for x in compared if x[0] == title)
    return E, G, mesh, rate


def test_figures_are_those_of_the_pages() -> None:
    (rows,) = (rows for header, *rows in tables(README) if header[0] == "E / G / M")
    assert len(rows) == 6
    for title, *surfaces, speed in rows:
        for k, cell in enumerate(surfaces):
            assert tuple(cell.replace("*", "").split(" / ")) == figures(title, k)[:3], (title, k)
        assert speed.replace("*", "") == figures(title, 0)[3], title


def test_wins_and_losses_beside_gmsh() -> None:
    """The ratios of E that the README, and the page on quality, give in words."""
    gmsh = "Gmsh, curvature size"
    found = {
        title: [float(figures(title, k)[0]) / float(figures(gmsh, k)[0]) for k in range(3)]
        for title in ("**balanced**", "**aligned**")
    }
    larger = [100 * x - 100 for x in found["**balanced**"]]
    assert f"is {min(larger):.0f} to {max(larger):.0f} % larger than that of Gmsh" in README
    on_lines = sorted(found["**aligned**"][:2])
    assert "has {:.2f} to {:.2f} times the E of Gmsh".format(*on_lines) in README
    faster = [float(of_quality(k)[0][gmsh]["balanced"].removesuffix(" ×")) for k in range(3)]
    assert f"is {min(faster):.0f} to {max(faster):.0f} times as fast as Gmsh" in README
