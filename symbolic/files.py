"""The files of generated/: the formulas of each file, and the values for its template."""

import difflib
import subprocess
import sys
import textwrap
from collections.abc import Mapping
from pathlib import Path

import sympy as sp

from . import (
    curve,
    elementary,
    faces,
    gaussian_image,
    jet,
    latex,
    mesh,
    offset,
    patch,
    proved,
    rational,
    spline,
    support,
    surfaces,
    tables,
    taylor,
)
from .emit import functions, named_tuples, render
from .loops import array_function, jet_function
from .positions import position, surface_jet
from .printer import source_of
from .tape import tape_steps

GENERATED = Path(__file__).parent.parent / "generated"
PROJECT = GENERATED.parent / "pyproject.toml"
# The title of each generated file of formulas, by the module that holds its formulas; file and
# module have the same name.
TITLES = {
    curve: "Planar curves: the formulas of symbolic/curve.py as functions of vectors.",
    elementary: "Elementary functions: the formulas and tables of symbolic/elementary.py.",
    faces: "Faces of CAD parts: the formulas of symbolic/faces.py as functions of vectors.",
    gaussian_image: "Gaussian images of patches: boundaries, solid angles, parabolic lines.",
    jet: "Surfaces at a point: the formulas of symbolic/jet.py as functions of vectors.",
    mesh: "Triangles through samples: the formulas of symbolic/mesh.py.",
    offset: "Fields of normals and rational offsets: the formulas of symbolic/offset.py.",
    patch: "One quadratic patch: the formulas of symbolic/patch.py as functions of vectors.",
    proved: "Points with a given normal, proved: the formulas of symbolic/proved.py.",
    rational: "Rational surfaces: the formulas of symbolic/rational.py.",
    spline: "The C1 quadratic spline: the grid, and the formulas of symbolic/spline.py.",
    taylor: "Taylor polynomials in two variables: the formulas of symbolic/taylor.py.",
}


def derive() -> dict[str, str]:
    """Return the contents of all generated files by their names."""
    before = {
        elementary: [elementary.constants()],
        patch: [f"NODE = {source_of(patch.quadrature_node())}"],
        spline: [tables.grid()],
    }
    sources = {
        f"{x.__name__.rpartition('.')[2]}.py": mathematics(
            title, *before.get(x, ()), functions(x.FORMULAS)
        )
        for x, title in TITLES.items()
    } | {
        "__init__.py": '"""Kernels and formulas written by `make generate`: never edit these."""\n',
        "differences.py": mathematics(
            "Weights of numerical derivatives: differences of nine points, also beside an edge.",
            tables.differences(),
        ),
        "icosahedron.py": mathematics(
            "The regular icosahedron: tables of its corners, edges and faces.",
            tables.icosahedron_tables(),
        ),
        "support.py": support_source(),
        "support_function.py": support_function_source(),
        "surface_jets.py": surface_jets_source(),
        "surface_tapes.py": surface_tapes_source(),
        "surfaces.py": surfaces_source(),
        "surfaces_signatures.pyi": signatures_source(),
        "vectors.py": vectors_source(),
    }
    modules = {name: formatted(text, name) for name, text in sorted(sources.items())}
    pages = {"formulas.md": latex.markdown(modules), "formulas.tex": latex.document(modules)}
    return modules | pages


def write(texts: Mapping[str, str], folder: Path) -> None:
    """Write files into a folder, and remove other files from it."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in existing(folder).keys() - texts.keys():
        (folder / name).unlink()
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


def differences(texts: Mapping[str, str], folder: Path) -> list[str]:
    """Return a unified diff from the files of a folder to the given texts, empty if equal."""
    old = existing(folder)
    lines: list[str] = []
    for name in sorted(old.keys() | texts.keys()):
        before, after = (x.get(name, "").splitlines(keepends=True) for x in (old, texts))
        lines += difflib.unified_diff(before, after, f"{folder.name}/{name}", f"derived/{name}")
    return lines


def existing(folder: Path) -> dict[str, str]:
    """Return the texts of the files of a folder."""
    paths = [path for path in folder.iterdir() if path.is_file()]
    return {path.name: path.read_text(encoding="utf-8", errors="replace") for path in paths}


def formatted(source: str, name: str = "module.py") -> str:
    """Return Python source, formatted by the settings of this project, without unused imports.

    Raises CalledProcessError if ruff is not installed or the source is not Python.
    """
    options = ["--config", str(PROJECT), "--no-cache", "--quiet", "--stdin-filename", name, "-"]
    for command in (["check", "--fix-only", "--select", "F401,I001"], ["format"]):
        run = subprocess.run(
            [sys.executable, "-m", "ruff", *command, *options],
            input=source,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            check=True,
        )
        source = run.stdout
    return source


# --- the files ------------------------------------------------------------------------------------


def mathematics(title: str, *parts: str) -> str:
    """Return a file of formulas and constants, without loops."""
    imports = (
        "import math\n\nimport numpy as np\n\n"
        "from .vectors import Arc, Hessian, Patch, PlaneVector, Vector, inline"
    )
    return "\n\n".join([_docstring(title), imports, "\n\n\n".join(parts)]) + "\n"


def loops(title: str, *parts: str) -> str:
    """Return a file of loops over arrays, which the runtime compiles."""
    return "\n\n".join([_docstring(title), "import math", "\n\n\n".join(parts)]) + "\n"


def vectors_source() -> str:
    """Return generated/vectors.py: types of arguments and results, and the decorator."""
    imports = "from typing import NamedTuple\n\nimport numba"
    decorator = (
        "# A formula is put into its callers before types are known, and not compiled by itself.\n"
        'inline = numba.njit(inline="always", nogil=True, error_model="numpy", fastmath=False)'
    )
    title = "The vectors that formulas take and return, and the decorator that inlines formulas."
    return f"{_docstring(title)}\n\n{imports}\n\n{decorator}\n\n\n{named_tuples()}\n"


def _docstring(title: str) -> str:
    """Return the docstring of a generated file: its title, and the command that wrote it."""
    how = f"make generate`, SymPy {sp.__version__}, float64, no fast-math"
    origin = f"Written by `{how}: do not edit, change symbolic/."
    return render("docstring.py", {"title": f'"""{title}', "origin": origin}).rstrip()


def support_source() -> str:
    """Return generated/support.py: formulas of support functions, offsets and curvatures."""
    title = "Support functions: the formulas of symbolic/support.py as functions of vectors."
    alone = [x for x in support.FORMULAS if x not in support.LOOPS]
    return mathematics(title, functions(alone))


def support_function_source() -> str:
    """Return generated/support_function.py: the support function of a patch and its derivatives."""
    title = (
        "The support function of a patch, its gradient, its Hessian and the curvatures, at many "
        "normals."
    )
    return loops(title, *(array_function(x, over) for x, over in support.LOOPS.items()))


def surfaces_source() -> str:
    """Return generated/surfaces.py: the positions of each surface, and the catalogue."""
    catalogue = surfaces.CATALOGUE.values()
    positions = (array_function(position(x), (x.u, x.v)) for x in catalogue)
    entries = "\n".join(map(_surface_entry, catalogue))
    return loops(
        "The catalogue of parametric surfaces: positions at many parameters, and data.",
        *positions,
        f"CATALOGUE = {{\n{entries}\n}}",
    )


def surface_jets_source() -> str:
    """Return generated/surface_jets.py: positions and derivatives of each surface."""
    catalogue = surfaces.CATALOGUE.values()
    return loops(
        "The catalogue of parametric surfaces: positions and derivatives at many parameters.",
        *(jet_function(surface_jet(x)) for x in catalogue),
        f"JETS = {{{', '.join(f'{x.name!r}: {x.name}' for x in catalogue)}}}",
    )


def surface_tapes_source() -> str:
    """Return generated/surface_tapes.py: the tape of the position of each surface."""
    title = "The catalogue of parametric surfaces: positions as steps of `symbolic/tape.py`."
    catalogue = surfaces.CATALOGUE.values()
    entries = (
        f"    {x.name!r}: {tape_steps(x.position, x.u, x.v, [*x.defaults])!r},\n" for x in catalogue
    )
    return f"{_docstring(title)}\n\nTAPES = {{\n{''.join(entries)}}}\n"


def signatures_source() -> str:
    """Return generated/surfaces_signatures.pyi: signatures of the functions of gaussmap.surfaces.

    The functions themselves are made at run time, from the catalogue; this file is for type
    checkers and completion.
    """
    title = "Signatures of gaussmap.surfaces for type checkers and completion; nothing runs this."
    functions = "\n\n".join(_signature(x) for x in surfaces.CATALOGUE.values())
    return f"{_docstring(title)}\n\nfrom ..runtime.surface.surface import Surface\n\n{functions}\n"


# --- the catalogue of surfaces --------------------------------------------------------------------


def _signature(surface: surfaces.ParametricSurface) -> str:
    arguments = ", ".join(
        f"{x.symbol.name}: float = {float(x.default)!r}" for x in surface.parameters
    )
    sentence = textwrap.indent(textwrap.fill(f'"""{surface.sentence}', 92), "    ")
    return f'def {surface.name}({arguments}) -> Surface:\n{sentence}\n    """'


def _surface_entry(surface: surfaces.ParametricSurface) -> str:
    parameters = ", ".join(
        f'"{x.symbol.name}": ({float(x.default)!r}, {x.positive}, {x.sentence!r})'
        for x in surface.parameters
    )
    domain = ", ".join(
        f"({source_of(sp.sympify(low))}, {source_of(sp.sympify(high))})"
        for low, high in surface.domain
    )
    return (
        f'    "{surface.name}": {{"position": {surface.name}, "sentence": {surface.sentence!r}, '
        f'"parameters": {{{parameters}}}, "domain": ({domain}), "boundary": {surface.boundary!r}}},'
    )
