"""Tests mirror the rooms of the package, and use public names: a room can be moved with its own."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import gaussmap as gm
import pytest

TESTS, PACKAGE = Path(__file__).parent, Path(str(gm.__file__)).parent
FILES = [
    *TESTS.glob("*.py"),
    *(path for side in ("runtime", "tools") for path in (TESTS / side).rglob("*.py")),
]
# Classes that functions return, which the reference documents where they are defined.
RETURNED = re.findall(
    r"^   (gaussmap\.\w+\.\S+)$",
    (PACKAGE / "docs" / "reference" / "python.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)
# Mathematics that results are compared with, and what kernels are made of, and by.
REFERENCE, FORMULAS = "gaussmap.symbolic", "gaussmap.generated"
DECORATORS = "gaussmap.runtime.machine_code.jit"
# What two fixtures hand to tests of other rooms, and what a test of all public calls needs.
EXCEPTIONS = {
    "conftest.py": {
        "gaussmap.tools.commands.cli.main",  # the command line in this process
        "gaussmap.tools.cad.examples",  # parts, which else come from files only
        "gaussmap.runtime.onto_surface.proved",
        "gaussmap.runtime.onto_surface.proved.index_of",  # what is not proved
        "gaussmap.tools.sampling.sample",
        "gaussmap.tools.sampling.sample.kept_map",
        "gaussmap.tools.sampling.stream",
        "gaussmap.tools.sampling.stream.kept_map",
    },
    "test_any_argument.py": {"gaussmap.tools.cad.examples.box"},
    # Faces of parts alone have borders that are sampled.
    "tools/cad/test_part_sampling.py": {"gaussmap.tools.density.space.PLACES_AT_A_TIME"},
}
# What tests of all rooms use.
SHARED = {path.stem for path in TESTS.glob("*.py") if not path.stem.startswith("test_")}
SIDES = ("gaussmap.runtime", "gaussmap.tools", "gaussmap.generated", "gaussmap.benchmarks")
PATCHING = {"setattr", "delattr", "patch", "import_module"}


def room_of(path: Path) -> str | None:
    """Return the room, or the module beside the rooms, that a file of tests is of."""
    side, *inner = path.relative_to(TESTS).parts
    name = (inner[0] if inner else "").removeprefix("test_").removesuffix(".py")
    there = len(inner) > 1 or (PACKAGE / side / f"{name}.py").exists()
    return f"gaussmap.{side}.{name}" if inner and there else None


def source_of(module: str) -> Path | None:
    """Return the file of a module of the package, None if there is no such module."""
    path = PACKAGE.joinpath(*module.split(".")[1:])
    return next((x for x in (path.with_suffix(".py"), path / "__init__.py") if x.exists()), None)


@cache
def public_names() -> frozenset[str]:
    """Return the names of the package, which the stub beside its `__init__.py` lists."""
    tree = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8"))
    imports = [x for x in ast.walk(tree) if isinstance(x, ast.ImportFrom)]
    return frozenset(alias.asname or alias.name for x in imports for alias in x.names)


def is_within(name: str, room: str | None) -> bool:
    return room is not None and f"{name}.".startswith(f"{room}.")


def is_open(module: str, name: str, room: str | None) -> bool:
    """Say whether the tests of a room may import a name of a module."""
    full = f"{module}.{name}"
    if module == "gaussmap":
        return name in public_names()
    if full in RETURNED or full == room:
        return True
    if module == DECORATORS or is_within(module, FORMULAS):  # has nothing else
        return source_of(f"{room}.kernels") is not None
    if not is_within(module, room) and not is_within(module, REFERENCE):
        return False
    return not name.startswith("_")


def imported(node: ast.AST) -> Iterator[tuple[str, str]]:
    """Return the modules of the package that a statement imports from, and the names."""
    if isinstance(node, ast.ImportFrom) and not node.level:
        yield from ((str(node.module), x.name) for x in node.names)
    if isinstance(node, ast.Import):
        parts = (x.name.rpartition(".") for x in node.names)
        yield from ((module, name) for module, _, name in parts)


def modules_of(tree: ast.AST) -> dict[str, str]:
    """Return the modules of the package that a file imports, by the names that it gives them."""
    imports = [x for x in ast.walk(tree) if isinstance(x, ast.ImportFrom) and not x.level]
    named = {y.asname or y.name: f"{x.module}.{y.name}" for x in imports for y in x.names}
    return {x: y for x, y in named.items() if y.startswith("gaussmap.") and source_of(y)}


def read_or_replaced(node: ast.AST, modules: dict[str, str]) -> Iterator[str]:
    """Return the attribute of a module that an expression reads or replaces."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        owner = (modules | {"gm": "gaussmap"}).get(node.value.id)
        if owner and not node.attr.startswith("__"):
            yield f"{owner}.{node.attr}"
    if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in PATCHING:
        first, *more = [x.value if isinstance(x, ast.Constant) else x for x in node.args]
        if isinstance(first, ast.Name) and first.id in modules and more:
            yield f"{modules[first.id]}.{more[0]}"
        elif isinstance(first, str):
            yield first


def is_inside(name: str, room: str | None) -> bool:
    """Say whether the tests of a room may not use an attribute of a module."""
    if name.startswith(SIDES) and not is_within(name, room):
        return name not in RETURNED
    return name.startswith("gaussmap.") and "._" in name


def violations(source: str, room: str | None) -> Iterator[str]:
    """Return what the tests of a room reach that is neither public nor of their room."""
    tree = ast.parse(source)
    modules = modules_of(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level > 1 and node.module not in SHARED:
            yield f"{'.' * node.level}{node.module}"
        for module, name in imported(node):
            if is_within(module, "gaussmap") and not is_open(module, name, room):
                yield f"{module}.{name}"
        yield from (x for x in read_or_replaced(node, modules) if is_inside(x, room))


@pytest.mark.parametrize("path", FILES, ids=lambda x: x.relative_to(TESTS).as_posix())
def test_public_names_are_used(path: Path) -> None:
    found = set(violations(path.read_text(encoding="utf-8"), room_of(path)))
    assert found - EXCEPTIONS.get(path.relative_to(TESTS).as_posix(), set()) == set()


@pytest.mark.parametrize(
    ("source", "room"),
    [
        ("import gaussmap.runtime.search.hits", "gaussmap.tools.sampling.stream"),
        ("from gaussmap.runtime.base.errors import InputError", "gaussmap.runtime.search"),
        ("from gaussmap.runtime.base.errors import shown", None),
        ("from gaussmap.runtime import search", None),
        ("from gaussmap.runtime.search.exact import _places", "gaussmap.runtime.search"),
        ("from gaussmap.runtime.search import exact; exact._places", "gaussmap.runtime.search"),
        ("from gaussmap.generated.patch import forms", "gaussmap.runtime.samples"),
        ("from gaussmap.benchmarks import guard", None),
        ("from ..search.test_exact import OPEN", "gaussmap.runtime.spline"),
        ("import gaussmap as gm; gm.runtime.base", None),
        ("import gaussmap as gm; gm._hidden", None),
        ("patch.setattr('gaussmap.runtime.search.exact.LONG', 1)", "gaussmap.tools.search"),
    ],
)
def test_what_is_inside_of_a_room_is_found(source: str, room: str | None) -> None:
    assert len([*violations(source, room)]) == 1


@pytest.mark.parametrize("side", ["runtime", "tools"])
def test_every_room_has_a_folder_of_tests_and_there_are_no_others(side: str) -> None:
    def folders(root: Path, pattern: str) -> set[Path]:
        return {path.parent.relative_to(root) for path in (root / side).glob(pattern)}

    assert folders(TESTS, "*/test_*.py") == folders(PACKAGE, "*/__init__.py")
    assert folders(TESTS, "**/test_*.py") <= folders(PACKAGE, "**/__init__.py")
