"""The boundary cone of an edge, from tangents at its ends, is V = 0 of the whole patch."""

import sympy as sp
from gaussmap.symbolic.gaussian_image import EDGE_VECTORS, TANGENTIAL
from gaussmap.symbolic.notation import Dot, scalar, substitute, vectors
from gaussmap.symbolic.patch import FORMS, TANGENTS


def components(names: str) -> list[sp.Symbol]:
    return [y for x in vectors(names) for y in x.components]


def test_the_form_of_an_edge_is_that_of_its_patch() -> None:
    tangents = TANGENTS.expanded()
    ends = {
        scalar(f"{name}{at}_{axis}"): substitute(
            tangents[f"{field}_{axis}"], {scalar("u"): sp.S(at), scalar("v"): sp.S.Zero}
        )
        for at in (0, 1)
        for name, field in (("T", "p_u"), ("X", "p_v"))
        for axis in "xyz"
    }
    found = {name: substitute(x, ends) for name, x in EDGE_VECTORS.expanded().items()}
    for symbol in components("abde"):
        assert sp.expand(found[symbol.name] - symbol) == 0
    form = FORMS.expanded()["V"]
    assert not {*components("c")} & form.free_symbols


def test_the_tangential_part_is_perpendicular() -> None:
    x, n, y = vectors("xny")
    found = TANGENTIAL.expanded()
    values = {symbol: found[symbol.name] for symbol in y.components}
    assert sp.expand(substitute(Dot(y, n).in_components(), values)) == 0
    square = Dot(n, n).in_components()
    for k, axis in enumerate("xyz"):
        rest = found[f"y_{axis}"] - square * x.components[k]
        assert sp.expand(rest / n.components[k] + Dot(x, n).in_components()) == 0
