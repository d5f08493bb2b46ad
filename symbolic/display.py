"""Formulas in mathematical notation: plain text and LaTeX."""

import re
from collections.abc import Callable, Sequence
from typing import Any, cast

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from .notation import Definition, Dot, VectorSymbol, scalar, substitute, vectors
from .printer import PositiveFirst

TEXT_WIDTH = 84
LATEX_WIDTH = 62


class Length(sp.Expr):
    """The length of a vector."""

    is_commutative = True
    is_positive = True


GREEK = {"mu": r"\mu", "kappa": r"\kappa", "rho": r"\rho", "beta": r"\beta"}

# The mathematical notation of quantities that have a single name in programs.
AS_WRITTEN = {
    scalar("c3_twice"): 2 * scalar("c_3"),
    scalar("n_n"): cast(sp.Expr, Length(*vectors("n"))) ** 2,
    scalar("R_sum"): scalar("R_1") + scalar("R_2"),
    scalar("R_product"): scalar("R_1") * scalar("R_2"),
}


def text(definitions: Sequence[Definition]) -> str:
    """Return definitions as plain text, one per line; long lines are continued."""
    lines = []
    for left, right in _equations(definitions):
        name = TextPrinter().doprint(left)
        rows = _rows(TextPrinter(), right, TEXT_WIDTH - len(name), len)
        lines += [f"{name} = {rows[0]}", *(f"{'':{len(name)}} {row}" for row in rows[1:])]
    return "\n".join(lines)


def latex(definitions: Sequence[Definition]) -> str:
    """Return definitions as an `aligned` block of LaTeX."""
    lines = []
    for left, right in _equations(definitions):
        rows = _rows(MathPrinter(), right, LATEX_WIDTH, _typeset_length)
        lines += [f"{latex_of(left)} &= {rows[0]}", *(f"&\\quad {{}} {row}" for row in rows[1:])]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


def latex_of(expression: sp.Expr, **settings: object) -> str:
    """Return an expression as LaTeX, vectors in bold; `settings` are those of `sympy.latex`."""
    return MathPrinter(settings).doprint(_as_written(expression))


def latex_name(name: str, *, bold: bool = False) -> str:
    """Return the LaTeX of the name of a symbol."""
    if bold and (gradient := re.fullmatch("d([UVDh])((?:_S)?)", name)):
        return rf"\nabla{gradient[2]} {gradient[1]}"
    if re.fullmatch("[a-e]{3}", name):
        return rf"[\mathbf{{{name}}}]"
    letter = re.fullmatch(rf"({'|'.join(GREEK)}|[A-Za-z])(\d*)((?:_[a-z\d]+)*)", name)
    if letter is None:
        word, index = cast(re.Match[str], re.fullmatch(r"(\w+?)(_[a-z])?", name)).groups()
        return r"\mathit{" + word.replace("_", r"\_") + "}" + (index or "")
    stem, digits, indices = letter.groups()
    words = [rf"\mathrm{{{x}}}" if len(x) > 2 else x for x in indices.split("_")]
    below = ",".join(x for x in (digits, *words) if x)
    if stem == "mu":
        below = below and rf"\mathrm{{{below}}}"
    stem = GREEK.get(stem, stem)
    if bold:
        stem = rf"\boldsymbol{{{stem}}}" if stem == r"\mu" else rf"\mathbf{{{stem}}}"
    return f"{stem}_{{{below}}}" if below else stem


class ForPeople(PositiveFirst):
    """A mixin for printers of mathematical notation: it prints products of vectors."""

    dot: str
    cross: str
    det: str

    def _print_Dot(self, expr: sp.Expr) -> str:
        return self.dot.join(map(cast(Any, self)._print, expr.args))

    def _print_Cross(self, expr: sp.Expr) -> str:
        return self.cross.join(map(cast(Any, self)._print, expr.args))

    def _print_Det(self, expr: sp.Expr) -> str:
        return f"{self.det}({', '.join(map(cast(Any, self)._print, expr.args))})"

    def _print_Length(self, expr: sp.Expr) -> str:
        return f"|{cast(Any, self)._print(expr.args[0])}|"


class TextPrinter(ForPeople, StrPrinter):
    """Print plain text."""

    dot, cross, det = "·", " × ", "det"

    def opening(self, size: sp.Expr) -> str:
        """Return the text before a sum of terms with a common coefficient."""
        numerator = size.as_numer_denom()[0]
        return "(" if numerator == 1 else f"{numerator}*("

    def closing(self, size: sp.Expr) -> str:
        """Return the text after a sum of terms with a common coefficient."""
        denominator = size.as_numer_denom()[1]
        return ")" if denominator == 1 else f")/{denominator}"

    def _print_Max(self, expr: sp.Expr) -> str:
        return f"max({', '.join(map(self.doprint, expr.args))})"

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        if expr.exp.is_Integer and expr.exp.is_negative:
            return f"1/{self.parenthesize(1 / expr, PRECEDENCE['Mul'])}"
        return super()._print_Pow(expr, rational)


class MathPrinter(ForPeople, LatexPrinter):
    """Print LaTeX, with vectors in bold."""

    dot, cross, det = r" \cdot ", r" \times ", r"\det"

    def opening(self, size: sp.Expr) -> str:
        """Return the text before a sum of terms with a common coefficient."""
        return rf"{self._print(size)} \bigl( "

    def closing(self, size: sp.Expr) -> str:
        """Return the text after a sum of terms with a common coefficient."""
        return r" \bigr)"

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:
        return latex_name(expr.name, bold=isinstance(expr, VectorSymbol))


def _as_written(value: sp.Expr) -> sp.Expr:
    """Return an expression in mathematical notation."""
    squares = {x: Length(x.args[0]) ** 2 for x in value.atoms(Dot) if x.args[0] == x.args[1]}
    return substitute(value, {**AS_WRITTEN, **squares})


def _equations(definitions: Sequence[Definition]) -> list[tuple[sp.Expr, sp.Expr]]:
    """Return both sides of definitions in mathematical notation; definitions x = x are left out."""
    pairs = ((_as_written(x), _as_written(value)) for x, value in definitions)
    return [(left, right) for left, right in pairs if left != right]


def _rows(
    printer: TextPrinter | MathPrinter, value: sp.Expr, width: int, size: Callable[[str], int]
) -> list[str]:
    """Print a sum in rows of a length of about `width`, as measured by `size`."""
    rows = [""]
    for term in _signed_terms(printer, value):
        if rows[-1] and size(rows[-1]) + size(term) > width:
            rows.append("")
        rows[-1] = f"{rows[-1]} {term}".strip()
    return rows


def _signed_terms(printer: TextPrinter | MathPrinter, value: sp.Expr) -> list[str]:
    """Print the terms of a sum; put terms with the same coefficient, up to its sign, in brackets.

    If only two terms have the same coefficient, they are bracketed only if the sum has no other
    terms.
    """
    groups: dict[sp.Expr, list[sp.Expr]] = {}
    terms = printer._as_ordered_terms(value) if value.is_Add else [value]
    sizes = [abs(_coefficient(x)) for x in terms]
    for term, size in zip(terms, sizes, strict=True):
        together = size != 1 and (sizes.count(size) > 2 or sizes.count(size) == len(sizes) > 1)
        groups.setdefault(size if together else term, []).append(term)
    result = [x for group in groups.values() for x in _bracketed(printer, group)]
    return [result[0].removeprefix("+ "), *result[1:]]


def _bracketed(printer: TextPrinter | MathPrinter, terms: list[sp.Expr]) -> list[str]:
    """Print terms with their signs; the common coefficient of several terms is printed once."""

    def signed(term: sp.Expr) -> str:
        printed = printer.doprint(term)
        return f"- {printed[1:].lstrip()}" if printed.startswith("-") else f"+ {printed}"

    if len(terms) == 1:
        return [signed(terms[0])]
    coefficient = _coefficient(terms[0])
    first, *others = (signed(x / coefficient) for x in terms)
    sign = "-" if coefficient.is_negative else "+"
    first = f"{sign} {printer.opening(abs(coefficient))}{first.removeprefix('+ ')}"
    return [first, *others[:-1], others[-1] + printer.closing(abs(coefficient))]


def _coefficient(term: sp.Expr) -> sp.Number:
    return term.as_coeff_Mul()[0]


def _typeset_length(source: str) -> int:
    """Return the approximate width of typeset LaTeX, in characters."""
    return len(re.sub(r"\\[a-zA-Z]+|[{}_^ \\]", "", source))
