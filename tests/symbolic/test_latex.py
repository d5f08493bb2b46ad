"""Formulas for people: plain text that says the same, LaTeX that is well formed, complete pages."""

import re
import shutil
import subprocess

import pytest
import sympy as sp
from gaussmap.symbolic import files, formulas, surfaces
from gaussmap.symbolic.display import latex_name
from gaussmap.symbolic.formula import Formula
from gaussmap.symbolic.latex import FORMULAS as SECTIONS
from gaussmap.symbolic.notation import Cross, Det, Dot, VectorSymbol, scalar, substitute, vectors
from gaussmap.symbolic.simplify import straight_line

MARKDOWN = (files.GENERATED / "formulas.md").read_text(encoding="utf-8")
TEX = (files.GENERATED / "formulas.tex").read_text(encoding="utf-8")
EACH_FORMULA = pytest.mark.parametrize("formula", formulas.values(), ids=formulas)


# --- plain text -----------------------------------------------------------------------------------


def parsed(side: str, formula: Formula) -> sp.Expr:
    """Read a side of an equation back into the notation of formulas."""
    symbols = {s.name: s for s in (*formula.inputs, *(x for x, _ in formula.definitions))}
    symbols |= {
        y.name: y for x in symbols.values() if isinstance(x, VectorSymbol) for y in x.components
    }
    names = symbols | {
        "Dot": Dot,
        "Cross": Cross,
        "det": Det,
        "sqrt": sp.sqrt,
        "Abs": sp.Abs,
        "max": sp.Max,
        "pi": sp.pi,
    }
    names |= {"Length": lambda x: sp.sqrt(Dot(x, x))}
    names |= {"c_3": scalar("c3_twice") / 2, "R_1": scalar("R_1"), "R_2": scalar("R_2")}
    side = re.sub(r"\|(\w+)\|", r"Length(\1)", side)
    side = re.sub(r"(\w+)·(\w+)", r"Dot(\1, \2)", side)
    side = re.sub(r"(\w+) × (\w+)", r"Cross(\1, \2)", side)
    return eval(side, {"__builtins__": {}}, names)


@EACH_FORMULA
def test_text_says_the_same(formula):
    """Parse the lines: they are the definitions. (n·n has no line of its own, but is |n|².)"""
    text = re.sub(r"\n +", " ", formula.text())
    pairs = dict(line.split(" = ") for line in text.splitlines())
    renamed = {"R_sum": "R_1 + R_2", "R_product": "R_1*R_2", "c3_twice": "2*c_3"}
    definitions = [(x, y) for x, y in formula.definitions if x.name != "n_n"]
    assert list(pairs) == [renamed.get(x.name, x.name) for x, _ in definitions]
    for (_, value), side in zip(definitions, pairs.values(), strict=True):
        expected = substitute(value, {scalar("n_n"): Dot(*vectors("nn"))})
        assert sp.expand(parsed(side, formula) - expected) == 0


# --- LaTeX of a formula ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "bold", "latex"),
    [
        ("A", False, "A"), ("n", True, r"\mathbf{n}"), ("p_u", True, r"\mathbf{p}_{u}"),
        ("p_u_x", False, "p_{u,x}"), ("b200", True, r"\mathbf{b}_{200}"),
        ("D111", False, "D_{111}"), ("mu", False, r"\mu"), ("rho", False, r"\rho"),
        ("mu_sw", True, r"\boldsymbol{\mu}_{\mathrm{sw}}"), ("H_xy", False, "H_{xy}"),
        ("K_offset", False, r"K_{\mathrm{offset}}"), ("dU", True, r"\nabla U"),
        ("dh", True, r"\nabla h"), ("dh_S", True, r"\nabla_S h"), ("dA", False, r"\mathit{dA}"),
        ("abc", False, r"[\mathbf{abc}]"), ("major", False, r"\mathit{major}"),
        ("half_width", False, r"\mathit{half\_width}"), ("slope_u", False, r"\mathit{slope}_u"),
    ],
)  # fmt: skip
def test_names(name, bold, latex):
    assert latex_name(name, bold=bold) == latex


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("forms", r"P &= \mathbf{n} \cdot \mathbf{d} \\"),
        ("forms", r"V &= B P - A Q \\"),
        ("support_function", r"h &= \mathbf{n} \cdot \mathbf{p} + \frac{P U + Q V}{2 D}"),
        ("tangents", r"\mathbf{N} &= \mathbf{p}_{u} \times \mathbf{p}_{v}"),
        ("principal_radii", r"R_{1} R_{2} &= \frac{|\mathbf{N}|^{2}}{D}"),
        ("orientation", r"2 c_{3} &= \det(\nabla U, \nabla V, \nabla D)"),
        ("gaussian_curvature_closed_form", r"K &= \frac{D^{5}}{c_{3}^{2} |\mathbf{n}|^{4}}"),
        ("coefficient", r"\mu &= 2 f - \frac{1}{4} \bigl( g_{0} + g_{1} + g_{2} + g_{3} \bigr)"),
        ("control_normals", r"\mathbf{N}_{200} &= \mathbf{s}_{100} \times \mathbf{t}_{100} \\"),
    ],
)
def test_lines_of_latex(name, line):
    assert line in formulas[name].latex().splitlines()


@EACH_FORMULA
def test_rows_of_latex_fit_on_a_page(formula):
    """About 90 characters fit on a line of 174 mm."""
    for row in formula.latex().splitlines():
        flat = re.sub(r"\\[a-zA-Z]+|[{}_^& ]", "", re.sub(r"\\frac\{1\}\{\d+\}", "1", row))
        assert len(flat) <= 90


# --- the two pages --------------------------------------------------------------------------------


def of_markdown(name: str) -> str:
    """Return what the page in Markdown says of a formula or surface."""
    return MARKDOWN.partition(f"### `{name}`\n")[2].partition("\n#")[0]


def of_tex(name: str) -> str:
    title = f"\\subsection*{{\\texttt{{{name}}}}}".replace("_", r"\_")
    return TEX.partition(title)[2].partition("\\subsection")[0]


def blocks() -> list[str]:
    return re.findall(r"^```math\n(.*?)\n```$", MARKDOWN, re.DOTALL | re.MULTILINE)


def inline() -> list[str]:
    return re.findall(r"\$`(.*?)`\$", MARKDOWN)


def is_balanced(latex: str) -> bool:
    """Check braces, environments and pairs of brackets that grow, and how they are nested."""
    token = re.compile(r"\\(?:begin|end)\{\w+\*?\}|\\(?:left|right|bigl|bigr)\b|(?<!\\)[{}]")
    closing = {"}": "{", r"\right": r"\left", r"\bigr": r"\bigl"}
    stack = []
    for mark in token.findall(latex):
        opener = closing.get(
            mark, mark.replace("end", "begin") if mark.startswith(r"\end") else None
        )
        if opener is None:
            stack.append(mark)
        elif not stack or stack.pop() != opener:
            return False
    return not stack


def test_every_formula_and_surface_is_a_block_of_its_own():
    entries = re.findall(r"^### `(\w+)`$", MARKDOWN, re.MULTILINE)
    assert entries == [*formulas, *surfaces.CATALOGUE]
    assert len(blocks()) == len(entries)
    assert re.findall(r"\\subsection\*\{\\texttt\{(.*?)\}\}", TEX) == [
        name.replace("_", r"\_") for name in entries
    ]
    for page, section in ((MARKDOWN, "## {}\n"), (TEX, "\\section{{{}}}\n")):
        for title in (*SECTIONS, "Parametric surfaces"):
            assert section.format(title) in page


def test_latex_is_balanced():
    snippets = [*blocks(), *inline()]
    assert len(snippets) > len(blocks()) > 40
    for latex in snippets:
        assert is_balanced(latex), latex
        assert latex.isascii()
        assert not {"`", "$"} & set(latex)


@EACH_FORMULA
def test_entries_name_source_inputs_and_operations(formula):
    code = straight_line(formula)
    operations = f"{code.operations_before} as written, {code.operations_after} as run."
    entry = of_markdown(formula.name)
    assert formula.latex() in entry
    assert f"\n- Source: {formula.source}.\n" in entry
    assert f"\n- Operations: {operations}" in entry
    assert entry.partition("- Inputs: ")[2].partition("\n")[0].count("$`") == len(formula.inputs)
    assert operations in of_tex(formula.name)


@pytest.mark.parametrize(
    ("name", "functions"),
    [
        ("curvature", "`patch.curvature`; part of `sample`, `curvature_at`, `branch`, "
         "`curvature_at_normal`."),
        ("support_function", "`patch.support_function`, `support_function.support_function`."),
        ("boundary_arc", "`gaussian_image.boundary_arc`."),
        ("coefficient_from_centres", "`spline.coefficient_from_centres`."),
        ("torus", "`surface_jets.torus`, `surfaces.torus`."),
        ("control_normals", "`patch.control_normals`."),
        ("sample", "`patch.sample`."),  # to `branch` u and v are known
    ],
)  # fmt: skip
def test_entries_name_the_functions(name, functions):
    assert of_markdown(name).partition("\n- Functions: ")[2].strip() == functions
    typeset = re.sub(r"`(.*?)`", r"\\texttt{\1}", functions).replace("_", r"\_")
    assert f"Functions: {typeset}" in of_tex(name)


@pytest.mark.parametrize("surface", surfaces.CATALOGUE.values(), ids=surfaces.CATALOGUE)
def test_entries_of_surfaces_name_position_domain_and_parameters(surface):
    entry = of_markdown(surface.name)
    assert surface.sentence in entry
    assert r"\mathbf{x}(u, v) &= \begin{pmatrix}" in entry
    assert r"(u, v) &\in [" in entry
    for parameter in surface.parameters:
        assert f"= {parameter.default}`$: {parameter.sentence}" in entry


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdflatex")
def test_the_document_compiles_and_fits(tmp_path):
    shutil.copy(files.GENERATED / "formulas.tex", tmp_path)
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "formulas.tex"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, errors="replace")
    assert run.returncode == 0, run.stdout
    assert "Overfull" not in run.stdout
    assert (tmp_path / "formulas.pdf").exists()
