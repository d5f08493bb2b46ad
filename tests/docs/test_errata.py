"""The pages in docs/ that a script writes are what the script gives."""

from pathlib import Path

import pytest
import sympy as sp
from gaussmap.docs import errata, orders, poles

from .pages import tables

DOCS = Path(__file__).parents[2] / "docs"


def test_errata_are_up_to_date():
    assert (DOCS / "errata.md").read_text(encoding="utf-8") == errata.page(), "run `make errata`"


def test_a_false_claim_makes_no_page(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(errata, "NUMERATOR_12", errata.NUMERATOR_12 + errata.n1**3)
    with pytest.raises(ArithmeticError):
        errata.control_points()


def test_lines_are_not_those_of_another_patch():
    vectors = errata.random_patch(3)
    errata.check_lines(vectors)
    _, cubic = errata.second_form(errata.patch(vectors)[0])
    q, rho, _ = errata.lines_of({**vectors, "d": vectors["e"], "e": vectors["d"]})
    product = sp.resultant(q.as_expr(), errata.u + errata.tau * errata.v + rho, errata.tau)
    assert not sp.cancel(cubic / product).is_number


def test_orders_have_a_row_for_each_surface():
    page = (DOCS / "orders.md").read_text(encoding="utf-8")
    assert page.startswith("# Orders of approximation, measured\n")
    *found, positions, normals = tables(page)  # the last two are those of poles
    assert len(found) == len(orders.QUANTITIES) + 1
    for quantity, (header, *rows) in zip(orders.QUANTITIES, found, strict=False):
        assert f"\n## {quantity.title}\n" in page
        assert header[1 : 1 + len(orders.GRIDS)] == [f"N = {x}" for x in orders.GRIDS]
        assert [row[0] for row in rows] == orders.regular_surfaces()
        assert {len(row) for row in rows} == {len(header)}
    assert len(found[-1][1:]) == 2 * sum("–" not in row for row in found[-2][1:])
    for header, *rows in (positions, normals):
        assert header[2:-1] == [f"N = {x}" for x in orders.GRIDS]
        places = [(x.name, region) for x in poles.surfaces() for region in poles.REGIONS]
        assert [(row[0], row[1]) for row in rows] == places


def test_orders_are_those_of_the_paper():
    found = tables((DOCS / "orders.md").read_text(encoding="utf-8"))
    for quantity, (header, *rows) in zip(orders.QUANTITIES, found, strict=False):
        slopes = [row[k] for row in rows for k, title in enumerate(header) if "slope" in title]
        assert len(slopes) == 2 * len(rows)
        numbers = [float(x) for x in slopes if x not in ("exact", "–")]
        assert len(numbers) >= 20
        assert min(numbers) > quantity.order - 0.1
