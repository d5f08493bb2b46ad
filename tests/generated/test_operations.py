"""The arithmetic of each formula and kernel is recorded in operations.json: changes are seen.

`make operations` writes the record. Counted is the source, each loop once, without what only
computes an index: [sums, differences and products; divisions; calls].
"""

import ast
import json
from pathlib import Path

ROOT = Path(__file__).parents[2]
# The files whose functions are counted; the names of kernels begin with their room.
GENERATED = sorted((ROOT / "generated").glob("*.py"))
KERNELS = sorted(x for y in ("runtime", "tools") for x in (ROOT / y).glob("*/kernels/*.py"))
RECORD = Path(__file__).with_name("operations.json")


class Counter(ast.NodeVisitor):
    """Counts operations on variables."""

    def __init__(self) -> None:
        self.sums_and_products = self.divisions = self.calls = 0

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)  # and not the index

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if has_variable(node):
            self._count(node.op)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._count(node.op)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        self.sums_and_products += isinstance(node.op, ast.USub) and has_variable(node)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        self.calls += 1
        self.generic_visit(node)

    def _count(self, operator: ast.operator) -> None:
        if isinstance(operator, ast.Div | ast.FloorDiv | ast.Mod):
            self.divisions += 1
        else:
            self.sums_and_products += 1


def has_variable(node: ast.AST) -> bool:
    return any(isinstance(x, ast.Name) and x.id != "math" for x in ast.walk(node))


def operations(function: ast.FunctionDef) -> list[int]:
    counter = Counter()
    for statement in function.body:
        counter.visit(statement)
    return [counter.sums_and_products, counter.divisions, counter.calls]


def counted() -> dict[str, list[int]]:
    """Return the counts of all formulas and kernels."""
    rooms = dict.fromkeys(GENERATED, "") | {x: f"{x.parts[-3]}." for x in KERNELS}
    return {
        f"{room}{path.stem}.{node.name}": operations(node)
        for path, room in rooms.items()
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    }


def test_operations_are_as_recorded():
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    found = counted()
    changed = [
        f"{name}: {record.get(name)} -> {found.get(name)}"
        for name in sorted(record.keys() | found.keys())
        if record.get(name) != found.get(name)
    ]
    hint = "operations of kernels changed; if that is meant: make operations"
    assert not changed, "\n".join([hint, *changed])


if __name__ == "__main__":
    lines = (f"    {json.dumps(name)}: {counts}" for name, counts in counted().items())
    RECORD.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
