"""The elementary functions of tapes: Taylor coefficients, their extrema and rounding errors."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import scalar

x, y, w = scalar("x"), scalar("y"), scalar("w")
HIGHEST = 3  # order of Taylor coefficients
# The assumed bound of relative errors of functions of the C library, in units of 2⁻⁵³: two units in
# the last place, which exceeds the errors that glibc states.
LIBRARY = 4


class Function(NamedTuple):
    """A function `of` x, and the terms in which its derivatives are written.

    `values` replaces expressions by terms in the value y of the function and, for some functions,
    in a second value w. `named` are terms that several derivatives share. If terms of a derivative
    cancel, the sum of their absolute values is at most `cancelling`. If the extrema of the Taylor
    coefficients are not known, `slopes` bound the derivatives of the function and of its Taylor
    coefficients.
    """

    of: Any
    values: Mapping[Any, Any] = {}
    named: Mapping[str, Any] = {}
    cancelling: Any = sp.S.Zero
    slopes: tuple[Any, ...] = ()

    @property
    def coefficients(self) -> list[Any]:
        """The function and its Taylor coefficients f1, f2, f3 at x, except at jumps."""
        found = (sp.diff(self.of, x, k) / sp.factorial(k) for k in range(HIGHEST + 1))
        return [f.replace(sp.DiracDelta, lambda *_: sp.S.Zero) for f in found]


FUNCTIONS = {
    "reciprocal": Function(1 / x, {x: 1 / y}),
    "square": Function(x**2),
    "cube": Function(x**3),
    "sqrt": Function(sp.sqrt(x), {x: 1 / w**2}, {"w": 1 / y}),
    "exp": Function(sp.exp(x), {sp.exp(x): y}),
    "log": Function(sp.log(x), {x: 1 / w}, {"w": 1 / x}),
    "sin": Function(sp.sin(x), {sp.sin(x): y, sp.cos(x): w}),
    "cos": Function(sp.cos(x), {sp.cos(x): y, sp.sin(x): w}),
    "sinh": Function(sp.sinh(x), {sp.sinh(x): y, sp.cosh(x): w}),
    "cosh": Function(sp.cosh(x), {sp.cosh(x): y, sp.sinh(x): w}),
    "tanh": Function(sp.tanh(x), {sp.tanh(x): y}, cancelling=sp.Rational(16, 3)),
    "asin": Function(sp.asin(x), {1 - x**2: 1 / w**2}, {"w": 1 / sp.sqrt((1 - x) * (1 + x))}),
    "atan": Function(
        sp.atan(x), {1 + x**2: 1 / w}, {"w": 1 / (1 + x**2)}, cancelling=sp.Rational(5, 3)
    ),
    # The rounding of x² adds x² units to the relative error of w = exp(−x²). Therefore `cancelling`
    # is a bound of the sums of absolute values multiplied by 1 + x²: these products are at most
    # 2/√π.
    "erf": Function(sp.erf(x), {sp.exp(-(x**2)): w}, cancelling=sp.Rational(8, 7)),
    # sin(x)/x is the integral of cos(t x) over t from 0 to 1, which gives the slopes. `cancelling`
    # is a bound for |x| ≥ 1.
    "sinc": Function(
        sp.sin(x) / x, {sp.sin(x): x * y, sp.cos(x): w}, cancelling=sp.Integer(3),
        slopes=tuple(1 / (sp.factorial(k) * (k + 2)) for k in range(HIGHEST + 1)),
    ),
    "sign": Function(sp.sign(x)),
}  # fmt: skip
# The codes of the operations of tapes. The operation "spline" has four rows of results: its own
# row, and the rows of the three operations "coordinate" that follow it.
BASIC = (
    "u",
    "v",
    "constant",
    "sum",
    "negative",
    "shift",
    "scale",
    "spline",
    "coordinate",
    "product",
)
CODES = {name: code for code, name in enumerate((*BASIC, *FUNCTIONS))}


def _formula(name: str, function: Function) -> Formula:
    coefficients = f"The Taylor coefficients $f1$, $f2$, $f3$ of {name} at $x$"
    decorate = formula(f"{name}_taylor", f"{coefficients}, from $x$ or values there.")
    return decorate(lambda: _taylor(function))


def _taylor(function: Function) -> Parts:
    positive = sp.Dummy(positive=True)
    values = {key: value.xreplace({w: positive}) for key, value in function.values.items()}
    outputs: list[Any] = [
        sp.factor(sp.powdenest(f.subs(values), force=True)).xreplace({positive: w})
        for f in function.coefficients[1:]
    ]
    given = sp.Tuple(*function.named.values(), *function.values.values(), *outputs).free_symbols
    return Parts(
        inputs=[z for z in (x, y, w) if z in given and z.name not in function.named],
        terms=function.named.items(),
        outputs=[(f"f{k + 1}", f) for k, f in enumerate(outputs)],
    )


# --- where coefficients have extremes, and how they are rounded -----------------------------------


def _critical(function: Function) -> tuple[float, list[float]]:
    """Return where Taylor coefficients may have extrema: a period, or 0, and isolated positions.

    For functions of sin and cos, the period is the distance of the zeros of both. Singularities
    count as extrema.
    """
    if function.slopes:
        return 0.0, []
    if function.of.has(sp.sin, sp.cos):
        return float(sp.pi / 2), []
    if function.of.has(sp.sign):
        return 0.0, [0.0]
    # SymPy does not know that the integral of exp(-x²) is continuous wherever exp(-x²) is.
    of = sp.diff(function.of, x) if function.of.has(sp.erf) else function.of
    domain = sp.calculus.util.continuous_domain(of, x, sp.S.Reals).interior
    slopes = [sp.diff(f, x) for f in function.coefficients]
    singular: Any = sp.calculus.singularities(of, x)
    found = [singular, *(_zeros(f, domain) for f in slopes if f.free_symbols)]
    return 0.0, sorted({float(place) for places in found for place in places})


def _zeros(slope: Any, domain: Any) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return the zeros of a derivative; SymPy finds them after rewriting in exponentials."""
    quotient: Any = sp.together(slope.rewrite(sp.exp))
    return sp.solveset(quotient.as_numer_denom()[0], x, domain)


def _roundings(expression: Any, known: Mapping[Any, int]) -> int:  # noqa: ANN401
    """Return the number of roundings of a term of an expression, including those of its symbols."""
    if expression in known:
        return known[expression]
    if expression.is_number:
        return int(not expression.is_Integer)
    base, exponent = expression.as_base_exp()
    if exponent == 1:
        counts = [_roundings(z, known) for z in expression.args]
        return (sum(counts) if expression.is_Mul else max(counts)) + len(counts) - 1
    if exponent.is_negative:
        return _roundings(base**-exponent, known) + 1
    if exponent == sp.S.Half:
        return _roundings(base, known) + 1
    return int(exponent) * (_roundings(base, known) + 1) - 1


def _roundings_of(function: Function, formula: Formula) -> list[int]:
    """Return the numbers of roundings of the value of a function and of its Taylor coefficients."""
    exact = function.of.is_Pow or function.of.has(
        sp.sign
    )  # except for the roundings of products, quotients and roots
    value = _roundings(function.of, {x: 0}) if exact else LIBRARY + bool(function.slopes)
    known = {x: 0, y: value, w: value}
    for symbol, term in formula.definitions:
        known[symbol] = _roundings(term, known)
    return [value, *(known[z] for z in formula.outputs)]


def constants() -> str:
    """Return the codes of operations, and tables with a row for each function.

    The tables contain the numbers of roundings of the value and of f1, f2, f3, each an error of
    2⁻⁵³ relative to the sum of the absolute values of their terms; the bounds of these sums if
    terms cancel; and the extrema of values and coefficients.
    """
    critical = [_critical(function) for function in FUNCTIONS.values()]
    width = max(len(places) for _, places in critical)
    rows = (", ".join([*map(str, z), *["np.nan"] * (width - len(z))]) for _, z in critical)
    roundings = [_roundings_of(z, _formula(name, z)) for name, z in FUNCTIONS.items()]
    return "\n".join(
        [
            "# The operations of tapes; from RECIPROCAL on, they are functions.",
            *(f"{name.upper()} = {code}" for name, code in CODES.items()),
            "# For each function: how often value, f1, f2 and f3 are rounded,",
            f"ROUNDINGS = np.array({roundings})",
            "# bounds of the sums of absolute values where terms cancel,",
            f"CANCELLING = np.array({[float(z.cancelling) for z in FUNCTIONS.values()]})",
            "# and where there are extremes: at multiples of this distance, and at these places.",
            f"SPACING = np.array({[distance for distance, _ in critical]})",
            f"EXTREMES = np.array([{', '.join(f'[{z}]' for z in rows)}])",
            "# Bounds of the slopes of a function and of f1, f2, f3 where they have others.",
            *(
                f"{name.upper()}_SLOPES = np.array({list(map(float, z.slopes))})"
                for name, z in FUNCTIONS.items()
                if z.slopes
            ),
        ]
    )


# --- sine and cosine, faster than those of the C library in loops ---------------------------------

# π/2 as a sum of numbers of PARTS bits and a remainder.
PARTS, PRECISION = (33, 33), 150


def _parts_of_quarter() -> list[Any]:
    """Return numbers whose sum is π/2.

    Products of small integers with these numbers are exact, except with the last number.
    """
    rest: Any = sp.Rational((sp.pi / 2).evalf(PRECISION))
    parts = []
    for bits in PARTS:
        unit = sp.Integer(2) ** (sp.floor(sp.log(rest, 2)) + 1 - bits)
        parts.append(unit * sp.floor(rest / unit))
        rest -= parts[-1]
    return [*parts, sp.Rational(float(rest))]


def _horner(function: Any, first: int, last: int, result: Any = sp.S.Zero) -> Any:  # noqa: ANN401
    """Return the terms of a Taylor series from x^first to x^last, divided by x^first, in z = x².

    `result` is the sum of the higher terms.
    """
    for order in range(last, first - 1, -2):
        term = sp.diff(function, x, order).subs(x, 0) / sp.factorial(order)
        result = term + z * result
    return result


def _sinc_series(order: int) -> Any:  # noqa: ANN401
    """Return the `order`-th Taylor coefficient, at a point x, of the function sin(x)/x.

    It is written as a truncated power series of x: a polynomial in z = x², times x if the order is
    odd.
    """
    result: Any = sp.S.Zero
    for power in range(LAST, order - 1, -2):
        coefficient = (-1) ** (power // 2) * sp.binomial(power, order) / sp.factorial(power + 1)
        result = coefficient + z * result
    return result * x if order % 2 else result


k, z = scalar("k"), scalar("z")
LAST = 20  # the power of x at which the series of sin(x)/x and of its derivatives end
FIRST_PART, SECOND_PART, LAST_PART = _parts_of_quarter()
REDUCED = Formula.build(
    "reduced_angle",
    "The difference $r$ of an angle $x$ and the nearest number $k$ of quarters of a turn. Products "
    "with the first two numbers, and the first difference, are exact for $|x|$ below 2**18, so "
    "that $r$ has two roundings; where most digits cancel, the second difference is exact, too.",
    inputs=[x, k],
    terms=[("s", x - k * FIRST_PART), ("t", scalar("s") - k * SECOND_PART)],
    outputs=[("r", scalar("t") - k * LAST_PART)],
)
SINE_AND_COSINE = Formula.build(
    "sine_and_cosine",
    "The sine $y$ and the cosine $w$ of an angle $x$ of at most an eighth of a turn, to two units "
    "of the last place, also if $x$ has two roundings: Taylor polynomials.",
    inputs=[x],
    terms=[
        ("z", x**2),
        ("y_1", _horner(sp.sin(x), 11, 17)),
        ("y_2", _horner(sp.sin(x), 3, 9, scalar("y_1"))),
        ("w_1", _horner(sp.cos(x), 12, 18)),
        ("w_2", _horner(sp.cos(x), 4, 10, scalar("w_1"))),
        ("a", x * z),
        ("b", z * scalar("w_2") - sp.S.Half),
    ],
    outputs=[("y", x + scalar("a") * scalar("y_2")), ("w", 1 + z * scalar("b"))],
)
SINC_SERIES = Formula.build(
    "sinc_series",
    "The function $y$ = sin($x$)/$x$ and its Taylor coefficients for $|x|$ up to 1: their series.",
    inputs=[x],
    terms=[("z", x**2)],
    outputs=[(name, _sinc_series(order)) for order, name in enumerate(("y", "f1", "f2", "f3"))],
)
FORMULAS = (
    *(_formula(*item) for item in FUNCTIONS.items() if any(item[1].coefficients[1:])),
    REDUCED,
    SINE_AND_COSINE,
    SINC_SERIES,
)
