"""The boundary cone of an edge, from tangents at its ends, is V = 0 of the whole patch."""

import sympy as sp
from gaussmap.symbolic.gaussian_image import EDGE_VECTORS, TANGENTIAL
from gaussmap.symbolic.notation import Dot, scalar, substitute, vectors
from gaussmap.symbolic.patch import FORMS, TANGENTS

from .calls import components, evaluated


def test_the_form_of_an_edge_is_that_of_its_patch() -> None:
    ends = {}
    for at in (0, 1):
        tangents = evaluated(TANGENTS, {scalar("u"): sp.S(at), scalar("v"): sp.S.Zero})
        for name, field in (("T", "p_u"), ("X", "p_v")):
            ends |= components(**{f"{name}{at}": [tangents[f"{field}_{axis}"] for axis in "xyz"]})
    found = evaluated(EDGE_VECTORS, ends)
    for vector in vectors("abde"):
        assert all(sp.expand(found[x.name] - x) == 0 for x in vector.components)
    assert not {*vectors("c")[0].components} & FORMS.expanded()["V"].free_symbols


def test_the_tangential_part_is_perpendicular() -> None:
    x, n, y = vectors("xny")
    found = TANGENTIAL.expanded()
    values = {symbol: found[symbol.name] for symbol in y.components}
    assert sp.expand(substitute(Dot(y, n).in_components(), values)) == 0
    square = Dot(n, n).in_components()
    for k, axis in enumerate("xyz"):
        rest = found[f"y_{axis}"] - square * x.components[k]
        assert sp.expand(rest / n.components[k] + Dot(x, n).in_components()) == 0
