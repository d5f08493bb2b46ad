"""All formulas and surfaces as a Markdown page for code hosts and as a LaTeX document."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import sympy as sp

from . import (
    curve,
    elementary,
    faces,
    gaussian_image,
    jet,
    mesh,
    offset,
    patch,
    proved,
    rational,
    spline,
    support,
    surfaces,
    taylor,
)
from .display import latex_name, latex_of
from .emit import render
from .formula import Formula
from .notation import VectorSymbol
from .positions import position
from .simplify import straight_line
from .uses import functions, wholes

GENERATOR = f"Written by `make generate` with SymPy {sp.__version__}: do not edit."
FORMULAS = {
    "One quadratic patch": patch.FORMULAS,
    "Fields of normals and rational offsets": offset.FORMULAS,
    "Gaussian images and parabolic points": gaussian_image.FORMULAS,
    "The quadratic spline": spline.FORMULAS,
    "Support functions": support.FORMULAS,
    "Surfaces at a point": jet.FORMULAS,
    "Rational surfaces": rational.FORMULAS,
    "Taylor polynomials": taylor.FORMULAS,
    "Elementary functions": elementary.FORMULAS,
    "Points with a given normal, proved": proved.FORMULAS,
    "Faces of CAD parts": faces.FORMULAS,
    "Meshes": mesh.FORMULAS,
    "Planar curves": curve.FORMULAS,
}
ENDS = {
    "open": "has edges",
    "periodic": "is periodic",
    "mirrored": "is periodic with a mirror image",
    "pole": "ends in poles",
}


@dataclass(frozen=True)
class Entry:
    """The texts of a formula or a surface; `$` encloses LaTeX in sentences and facts."""

    formula: Formula
    sentence: str
    aligned: str
    facts: tuple[str, ...]

    @property
    def name(self) -> str:
        """The name of the formula or surface."""
        return self.formula.name


def parts_of(formula: Formula) -> list[str]:
    """Return the names of the formulas that contain this formula."""
    return wholes(formula, (x for section in FORMULAS.values() for x in section))


def markdown(sources: Mapping[str, str]) -> str:
    """Return generated/formulas.md, in the Markdown of code hosts, which render formulas.

    `sources` are the texts of the generated files by their names.
    """
    found = functions(sources)
    parts = []
    for title, entries in sections().items():
        parts.append(f"## {title}")
        for entry in entries:
            parts += [f"### `{entry.name}`", *passages(entry, found)]
    return render("formulas.md", {"generator": GENERATOR, "sections": "\n\n".join(parts)})


def passages(entry: Entry, found: Mapping[str, list[str]]) -> tuple[str, str, str]:
    """Return sentence, formula and list of facts of an entry, in the Markdown of code hosts.

    `found` are the generated functions of each formula, by the name of the formula.
    """

    def converted(sentence: str) -> str:
        return _converted(sentence, mathematics=lambda x: f"$`{x}`$")

    facts = (*entry.facts, _functions(entry, found))
    return (
        converted(entry.sentence),
        f"```math\n{entry.aligned}\n```",
        "\n".join(f"- {converted(fact)}" for fact in facts),
    )


def document(sources: Mapping[str, str]) -> str:
    """Return generated/formulas.tex, a complete LaTeX document; `sources` as in `markdown`."""
    found = functions(sources)

    def converted(sentence: str) -> str:
        return _converted(sentence, mathematics=lambda x: f"${x}$", plain=_escaped)

    parts = []
    for title, entries in sections().items():
        parts.append(f"\\section{{{title}}}\n")
        for entry in entries:
            parts += [
                f"\\subsection*{{{_escaped(f'`{entry.name}`')}}}",
                converted(entry.sentence),
                entry.aligned.replace("{aligned}", "{align*}"),
                "\\\\*\n".join(map(converted, (*entry.facts, _functions(entry, found)))) + "\n",
            ]
    return render("formulas.tex", {"generator": f"% {GENERATOR}", "sections": "\n".join(parts)})


# --- entries --------------------------------------------------------------------------------------


@cache
def sections() -> dict[str, list[Entry]]:
    """Return the entries of each section, by the title of the section."""
    result = {title: [_formula(x) for x in formulas] for title, formulas in FORMULAS.items()}
    return result | {"Parametric surfaces": [_surface(x) for x in surfaces.CATALOGUE.values()]}


def _formula(formula: Formula) -> Entry:
    return Entry(
        formula,
        _converted(formula.description, mathematics=lambda x: f"${_named(x, formula)}$"),
        formula.latex(),
        (
            f"Source: {formula.source}.",
            f"Inputs: {', '.join(f'${latex_of(x)}$' for x in formula.inputs)}.",
            _operations(formula),
        ),
    )


def _surface(surface: surfaces.ParametricSurface) -> Entry:
    """Return the entry of a surface: position, domain, parameters, and boundary conditions."""

    def latex(expression: sp.Expr) -> str:
        return latex_of(expression, fold_short_frac=True, mul_symbol=r" \, ")

    coordinates = [latex(x).replace("\\frac", "\\dfrac") for x in surface.position]
    gap = "12pt" if any("\\dfrac" in x for x in coordinates) else "4pt"
    column = f" \\\\[{gap}]\n".join(coordinates)
    intervals = [", ".join(map(latex, ends)) for ends in surface.domain]
    lines = [
        "\\begin{aligned}",
        f"\\mathbf{{x}}(u, v) &= \\begin{{pmatrix}}\n{column}\n\\end{{pmatrix}} \\\\[4pt]",
        "(u, v) &\\in " + " \\times ".join(f"[{x}]" for x in intervals),
        "\\end{aligned}",
    ]
    parameters = (f"${latex_of(x.symbol)} = {x.default}$: {x.sentence}" for x in surface.parameters)
    ends = ", ".join(
        f"${name}$ {' and '.join(ENDS[x] for x in dict.fromkeys(ends))}"
        for name, ends in zip("uv", surface.boundary, strict=True)
    )
    return Entry(
        position(surface),
        surface.sentence,
        "\n".join(lines),
        (*parameters, f"{ends}.", _operations(position(surface))),
    )


def _functions(entry: Entry, found: Mapping[str, list[str]]) -> str:
    """Return a fact: the generated functions of a formula, and the formulas that contain it."""
    own = ", ".join(f"`{x}`" for x in found.get(entry.name, ())) or "none"
    parts = ", ".join(f"`{x}`" for x in parts_of(entry.formula))
    return f"Functions: {own}" + (f"; part of {parts}." if parts else ".")


def _operations(formula: Formula) -> str:
    code = straight_line(formula)
    return f"Operations: {code.operations_before} as written, {code.operations_after} as run."


# --- sentences ------------------------------------------------------------------------------------


def _converted(
    sentence: str, *, mathematics: Callable[[str], str], plain: Callable[[str], str] = str
) -> str:
    """Return a sentence with mathematics (between dollar signs) and other text converted."""
    parts = sentence.split("$")
    parts[::2] = map(plain, parts[::2])
    parts[1::2] = map(mathematics, parts[1::2])
    return "".join(parts)


@cache
def _vectors() -> set[str]:
    """Return the names that are vectors in all formulas that use them."""
    formulas = [x for section in FORMULAS.values() for x in section]
    symbols = {s for x in formulas for s in _symbols(x)}
    scalars = {s.name for s in symbols if not isinstance(s, VectorSymbol)}
    return {s.name for s in symbols if isinstance(s, VectorSymbol)} - scalars


def _symbols(formula: Formula) -> tuple[sp.Symbol, ...]:
    return *formula.inputs, *(name for name, _ in formula.definitions)


def _named(source: str, formula: Formula) -> str:
    """Return mathematics from a formula's sentence as LaTeX; vectors of the formula are bold."""
    bold = _vectors() | {s.name for s in _symbols(formula) if isinstance(s, VectorSymbol)}

    def latex(name: re.Match[str]) -> str:
        return r"\det" if name[0] == "det" else latex_name(name[0], bold=name[0] in bold)

    names = re.sub(r"[A-Za-z]\w*", latex, source)
    return names.replace("×", r"\times").replace("…", r"\ldots").replace("−", "-")


def _escaped(text: str) -> str:
    """Return plain text escaped for LaTeX; text between backquotes becomes typewriter text."""
    escaped = re.sub(r"([<>])", r"$\1$", re.sub(r"([_&%#])", r"\\\1", text))
    return re.sub(r"`(.*?)`", r"\\texttt{\1}", escaped)
