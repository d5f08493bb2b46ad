"""Random texts in the language of users' formulas, most of which have a mistake."""

from gaussmap.symbolic.reading import FUNCTIONS
from hypothesis import strategies as st

NUMBERS = ["0", "1", "2", "-1", "0.5", "1/3", "pi", "E", "10**50", "1e300", "99"]
ATOMS = st.sampled_from(NUMBERS) | st.sampled_from(["u", "v", "u", "v", "True", "u > v", "k"])
NAMES = st.sampled_from([*sorted(FUNCTIONS), "acsch", "gamma"])
SIGNS = st.sampled_from(["+", "-", "*", "/", "**", "%", "//", "<", ">=", "==", "&", "|"])


def _larger(texts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    calls = st.builds(lambda f, x: f"{f}({', '.join(x)})", NAMES, st.lists(texts, max_size=3))
    operations = st.builds(lambda a, sign, b: f"({a}) {sign} ({b})", texts, SIGNS, texts)
    pieces = st.builds(lambda a, b, c: f"Piecewise(({a}, {b}), ({c}, True))", texts, texts, texts)
    sums = st.builds(lambda a, n: f"Sum({a}*k, (k, 1, {n}))", texts, st.integers(0, 10**9) | texts)
    return calls | operations | operations | pieces | sums


def texts(leaves: int) -> st.SearchStrategy[str]:
    """Return texts with at most `leaves` numbers and symbols."""
    return st.recursive(ATOMS, _larger, max_leaves=leaves)
