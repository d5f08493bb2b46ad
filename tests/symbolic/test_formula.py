"""Formulas: vectors and scalars, components, composition, text and LaTeX."""

import subprocess
import sys

import pytest
import sympy as sp
from gaussmap.symbolic import Formula, formulas
from gaussmap.symbolic.formula import BEYOND_THE_PAPER, Parts, compose, formula
from gaussmap.symbolic.notation import (
    Cross,
    Det,
    Dot,
    PlaneVector,
    VectorSymbol,
    components,
    dot,
    is_vector,
    scalar,
    substitute,
    vectors,
)

from ..refusals import refused

a, b, c = vectors("abc")
s, t = scalar("s"), scalar("t")
a_x, a_y, a_z = a.components
b_x, b_y, b_z = b.components


def built(**changes) -> Formula:
    arguments = {"inputs": [a, b, s], "outputs": [("x", s * a + b)]} | changes
    return Formula.build("name", "A $sentence$.", **arguments)


# --- vectors --------------------------------------------------------------------------------------


def test_components_of_products():
    assert components(Dot(a, b)) == (a_x * b_x + a_y * b_y + a_z * b_z,)
    (determinant,) = components(Det(a, b, c))
    assert sp.expand(determinant - sp.Matrix.hstack(a.column, b.column, c.column).det()) == 0
    assert components(Cross(a, b)) == (
        a_y * b_z - a_z * b_y,
        a_z * b_x - a_x * b_z,
        a_x * b_y - a_y * b_x,
    )


def test_vectors_of_the_plane():
    r, q = PlaneVector("r"), PlaneVector("q")
    (r_x, r_y), (q_x, q_y) = r.components, q.components
    assert [x.name for x in (r_x, r_y)] == ["r_x", "r_y"]
    assert components(Dot(r, q)) == (r_x * q_x + r_y * q_y,)
    assert components(Det(r, q)) == (r_x * q_y - r_y * q_x,)
    assert components(s * r - q) == (s * r_x - q_x, s * r_y - q_y)
    formula = built(inputs=[r, s], outputs=[("y", s * r), ("z", Dot(r, r))])
    assert formula.outputs == (PlaneVector("y"), scalar("z"))
    assert PlaneVector("y") != VectorSymbol("y")


@pytest.mark.parametrize("value", [a + PlaneVector("r"), s * a - PlaneVector("r")])
def test_vectors_of_plane_and_space_do_not_mix(value):
    refused(r"shorter|longer", components, value, error=ValueError)


@pytest.mark.parametrize(
    ("value", "answer"),
    [(a, True), (s * a, True), (Cross(a, b), True), (Dot(a, b) * a, True), (a + b, True),
     (s, False), (Dot(a, b), False), (Det(a, b, c), False), (sp.sqrt(Dot(a, a)), False),
     (sp.Integer(0), False)],
)  # fmt: skip
def test_what_is_a_vector(value, answer):
    assert is_vector(value) is answer


@pytest.mark.parametrize("value", [a + s, a * b, a**2, sp.sqrt(a), 1 / a, Cross(a, b) + 1])
def test_nonsense_is_refused(value):
    refused("mixes scalars and vectors", is_vector, value, error=ValueError)


def test_substitution_is_simultaneous():
    assert substitute(s + 2 * t, {s: t, t: s}) == t + 2 * s


# --- formulas -------------------------------------------------------------------------------------


def test_build_tells_vectors_from_scalars():
    formula = built(terms=[("r", Dot(a, b))], outputs=[("x", scalar("r") * a), ("y", s)])
    assert [symbol for symbol, _ in formula.definitions] == [
        scalar("r"),
        VectorSymbol("x"),
        scalar("y"),
    ]
    assert formula.outputs == (VectorSymbol("x"), scalar("y"))
    assert formula.source == BEYOND_THE_PAPER
    assert formula.sentence == "A sentence."


def test_components_of_a_defined_vector_can_be_used():
    formula = built(terms=[("x", s * a)], outputs=[("h", VectorSymbol("x").components[1] ** 2)])
    assert formula.expanded() == {"h": s**2 * a_y**2}


def test_undefined_symbols_and_double_definitions_are_refused():
    undefined = {"inputs": [a, s], "outputs": [("x", s * a + t * b)]}
    refused(r"name: x uses undefined \['b', 't'\]", built, **undefined, error=ValueError)
    for name in ("s", "r"):
        terms = [("r", s), (name, 2 * s)]
        refused(f"name: {name} is defined twice", built, terms=terms, error=ValueError)


def test_a_formula_is_derived_once_when_it_is_first_read():
    calls = []

    @formula("double", "Twice $s$.")
    def double() -> Parts:
        calls.append(s)
        return Parts(inputs=[s], outputs=[("x", 2 * s)])

    both = compose("both", "", [double], source="x", outputs=[scalar("x")])
    assert (double.name, double.sentence, both.name, calls) == ("double", "Twice s.", "both", [])
    assert both.expanded() == double.expanded() == {"x": 2 * s}
    assert double.inputs == (s,)
    assert calls == [s]


def test_equal_formulas_have_the_same_definitions():
    assert built() == built()
    assert hash(built()) == hash(built())
    assert built() != built(outputs=[("x", s * a)])
    assert built() != "name"


READ_ONE = """
import sys
from gaussmap.symbolic import formulas
for formula in formulas.values():
    assert formula.sentence
formulas[sys.argv[1]].text()
print(*(name for name, x in formulas.items() if "_content" in vars(x)))
"""


def test_only_what_is_read_is_derived():
    """Those that are built of lists are there; of the others one is asked for."""
    run = [sys.executable, "-c", READ_ONE, "at_pole"]
    read = subprocess.run(run, capture_output=True, text=True, check=True).stdout.split()
    assert "at_pole" in read
    assert {"parabolic_cubic", "sample", "triangle", "product_3"}.isdisjoint(read)


# --- composition ----------------------------------------------------------------------------------

FIRST = Formula.build("first", "", inputs=[a, s], outputs=[("r", s * Dot(a, a)), ("q", s + 1)])
SECOND = Formula.build("second", "", inputs=[scalar("r"), t], outputs=[("h", scalar("r") * t)])


def test_compose_feeds_the_later_parts_and_drops_what_is_not_needed():
    both = compose("both", "", [FIRST, SECOND], source="x", outputs=[scalar("h")])
    assert both.inputs == (a, s, t)
    assert [symbol.name for symbol, _ in both.definitions] == ["r", "h"]
    assert both.expanded() == {"h": s * dot(a.column, a.column) * t}


OTHER = Formula.build("other", "", inputs=[s], outputs=[("r", s**2)])


@pytest.mark.parametrize(
    ("part", "output", "words"),
    [(OTHER, "r", "two parts define r differently"), (SECOND, "w", r"no part defines \['w'\]")],
)
def test_compose_refuses_two_meanings_and_none(part, output, words):
    both = compose("both", "", [FIRST, part], source="x", outputs=[scalar(output)])
    refused(words, lambda: both.definitions, error=ValueError)


# --- what users see -------------------------------------------------------------------------------


@pytest.mark.parametrize("formula", formulas.values(), ids=formulas)
def test_every_formula_says_what_it_is(formula):
    assert formula.name.isidentifier()
    assert formula.sentence.endswith(".")
    assert formula.description.count("$") % 2 == 0
    assert formula.source == BEYOND_THE_PAPER or "eq" in formula.source or "Sect" in formula.source


def test_notebooks_show_the_latex():
    formula = formulas["envelope"]
    assert formula._repr_latex_() == f"$\\displaystyle {formula.latex()}$"
