"""The measurements of docs/orders.py, on small grids, against theory and the runtime itself."""

import re
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.docs import errata, markdown, orders, poles
from gaussmap.docs.exact import angles
from gaussmap.docs.orders import ANGLES, QUANTITIES, SUPPORT

from .pages import tables

GRIDS = (16, 32)
NORMALS = gm.fibonacci(3_000)
CUBIC = ("monkey_saddle", "enneper")
CURVED = (*CUBIC, "torus", "hyperboloid", "helicoid", "wavy_graph")
FLAT = ("cylinder", "cone")
QUADRATIC = ("elliptic_paraboloid", "plane")


@pytest.fixture(scope="module")
def measured():
    return {name: orders.measure(name, GRIDS, NORMALS) for name in (*CURVED, *FLAT, *QUADRATIC)}


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda x: x.title)
@pytest.mark.parametrize("name", CURVED)
def test_order(measured, name, quantity):
    # terms of the next order are still felt on coarse grids; on cubics there are none
    above = 0.1 if name in CUBIC else 1.2
    assert quantity.order - 0.1 < measured[name].slope(quantity) < quantity.order + above


def test_quadratics_are_reproduced(measured):
    for name in QUADRATIC:
        assert measured[name].true.reproduced
        assert np.nanmax(measured[name].errors) < 1e-11
    assert not any(measured[name].true.reproduced for name in (*CURVED, *FLAT))


def test_developable_surfaces_have_no_support_function(measured):
    for name in (*FLAT, "plane"):
        assert measured[name].true.developable
        assert measured[name].support == []
        assert np.isnan(measured[name].errors[QUANTITIES.index(SUPPORT)]).all()


def test_normals_of_the_cylinder_are_faster(measured):
    assert measured["cylinder"].slope(ANGLES) == pytest.approx(3.0, abs=0.1)
    assert measured["cone"].slope(ANGLES) == pytest.approx(2.0, abs=0.1)
    entries = (measured[name].true.entry for name in FLAT)
    assert [orders.third_derivatives_are_tangent(entry) for entry in entries] == [True, False]


@pytest.mark.parametrize("name", ["torus", "moebius_band"])
def test_errors_at_parameters_are_those_of_the_runtime(name):
    cells, parts = 6, 2 * orders.PARTS
    true = orders.TrueSurface(name)
    spline = gm.fit(true.surface, (cells, cells))
    u, v = np.meshgrid(
        *(np.linspace(*ends, cells * parts + 1) for ends in true.surface.domain), indexing="ij"
    )
    position, _, angle = orders.parameter_errors(true, cells)
    # the places of orders.py are among these, and the border is among both
    apart = np.linalg.norm(spline.evaluate(u, v) - true.surface.evaluate(u, v), axis=-1)
    assert position == pytest.approx(apart.max(), rel=0.05)
    assert position <= apart.max() + 1e-12
    places = true.unit(np.stack([u, v], axis=-1))
    x_u, x_v = np.moveaxis(true.derivatives(places[..., 0], places[..., 1], 1)[..., 1:, :], -2, 0)
    exact = np.cross(x_u, x_v)
    assert angle == pytest.approx(angles(spline.normals(u, v), exact).max(), rel=0.05)


def test_newton_agrees_with_closed_forms():
    for name in ("torus", "ellipsoid_patch", "hyperboloid"):
        found = orders.support_errors(orders.TrueSurface(name), 16, NORMALS)
        assert found.compared > 500
        assert found.closed_form < 1e-14


def test_the_sum_of_compared_and_left_out_is_all(measured):
    for name in CURVED:
        for cells, found in zip(GRIDS, measured[name].support, strict=True):
            spline = gm.fit(gm.surfaces.surface(name), (cells, cells))
            samples = gm.sample(spline, normals=NORMALS)
            assert found.compared + sum(found.left_out.values()) == len(samples)
            assert found.compared > 0.95 * len(samples)


def test_regular_and_singular_surfaces_are_the_catalogue():
    assert sorted(orders.regular_surfaces() + orders.singular_surfaces()) == sorted(
        gm.surfaces.names()
    )
    assert orders.singular_surfaces() == ["ellipsoid", "sphere"]
    with pytest.raises(ArithmeticError, match="sphere has a singular point"):
        _ = orders.TrueSurface("sphere").largest_curvature


def test_errors_next_to_poles():
    """Positions have order 3 everywhere, normals order 1 in the first row of a generic surface."""
    errors = {x.name: [poles.measured(x.name, n) for n in GRIDS] for x in poles.surfaces()}
    assert list(errors) == ["ellipsoid", "sphere", "egg"]
    for name, found in errors.items():
        positions = np.log2(found[0].positions / found[1].positions)
        normals = np.log2(found[0].normals / found[1].normals)
        assert (positions > 2.9).all()
        assert normals[-1] > 1.9
        assert normals[0] == pytest.approx(1.0 if name == "egg" else 2.0, abs=0.1)
        assert max(x.at_pole for x in found) < 1e-5
    assert [x.normals[0] for x in errors["egg"]] == pytest.approx([4.49, 2.18], abs=0.01)


def test_the_page_has_all_tables(measured):
    """With all numbers and tables in their places: none is left over."""
    chosen = [measured[name] for name in ("torus", "plane", "cylinder")]
    text = orders.page(chosen)
    assert text.count("\n| :-- |") == len(QUANTITIES) + 3
    assert not re.search(r"[{}]|^\[[\w ]+\]$", text, re.MULTILINE)


def test_numbers():
    values = (8.6473e-5, 0.02704, 4.031, 151.2, 7.999e-16)
    assert list(map(markdown.number, values)) == ["8.65e-5", "0.027", "4.03", "151", "8.00e-16"]
    assert [markdown.above(x) for x in (0.0, 3e-16, 9e-13)] == ["0", "< 1e-15", "< 1e-12"]


# --- pages that a script writes -------------------------------------------------------------------

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
