"""Products of values: quick cases cover each value, or each pair; the other cases are slow."""

from collections.abc import Iterable
from itertools import combinations, product
from typing import Any

import pytest


def covering(**axes: Iterable[Any]) -> pytest.MarkDecorator:
    """Parametrize a test by all combinations of values, of which a covering array is quick.

    With two axes each value is in a quick case, with more axes each pair of values. A key may name
    several arguments, as in `pytest.mark.parametrize`.
    """
    sizes = [[*values] for values in axes.values()]
    cases = [*product(*(range(len(x)) for x in sizes))]
    quick, strength = set(), 1 if len(sizes) < 3 else 2
    left = {x for case in cases for x in combinations(enumerate(case), strength)}
    while left:  # take the first case that covers most of what is left
        best = max(cases, key=lambda case: len(left & {*combinations(enumerate(case), strength)}))
        quick.add(best)
        left -= {*combinations(enumerate(best), strength)}
    names = [[name.strip() for name in key.split(",")] for key in axes]
    params = []
    for case in cases:
        marks = [] if case in quick else [pytest.mark.slow]
        values = []
        for group, of_axis, k in zip(names, sizes, case, strict=True):
            values += [of_axis[k]] if len(group) == 1 else of_axis[k]
        params.append(pytest.param(*values, marks=marks))
    return pytest.mark.parametrize([x for group in names for x in group], params)
