"""The public interface, found and not listed, for tests that hold for all of it."""

import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any

import gaussmap as gm
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.runtime.spline.misfit import Misfit
from gaussmap.tools.support.branches import Branches
from gaussmap.tools.support.convolution import Convolution

NAMESPACES = {"curves", "directions", "errors", "gauss_map", "surfaces"}
# Classes that the functions return, beside those that have public names.
RETURNED = {
    "Branches": Branches,
    "Convolution": Convolution,
    "Misfit": Misfit,
    "SamplingReport": SamplingReport,
}


def public() -> dict[str, Any]:
    """Return all public objects by their names; `symbolic` documents its formulas itself."""
    spaces = {name: getattr(gm, name) for name in sorted(NAMESPACES)}
    top = [name for name in dir(gm) if not name.startswith("_")]
    modules = {name for name in top if isinstance(getattr(gm, name), ModuleType)}
    assert modules == NAMESPACES | {"symbolic"}
    found = {name: getattr(gm, name) for name in top if name not in modules}
    for space, module in spaces.items():
        found |= {f"{space}.{name}": getattr(module, name) for name in module.__all__}
    found |= {f"surfaces.{name}": getattr(gm.surfaces, name) for name in gm.surfaces.names()}
    return found | RETURNED


def members(cls: type) -> dict[str, Any]:
    """Return the public members of a class that gaussmap defines, and the names of its fields.

    Those of a public class that it extends, such as `Samples`, are members of that one.
    """
    found: dict[str, Any] = dict.fromkeys(getattr(cls, "__dataclass_fields__", ()))
    for base in reversed(cls.__mro__):
        if base.__module__.startswith("gaussmap"):
            names = [x for x in vars(base) if x not in found]
            for x in names:
                getattr(cls, x)  # some methods are put into the class when first asked for
            found |= {x: vars(base)[x] for x in names}
    bases = [x for x in cls.__mro__[1:] if x in PUBLIC.values()]
    others = {x for base in bases for x in members(base)} - {*vars(cls)}
    return {x: y for x, y in found.items() if not x.startswith("_") and x not in others}


def methods_of(cls: type) -> dict[str, Callable[..., Any]]:
    """Return the public methods, class methods included, by their names."""
    kinds = (classmethod, staticmethod)
    return {
        name: getattr(cls, name)
        for name, x in members(cls).items()
        if inspect.isfunction(x) or isinstance(x, kinds)
    }


PUBLIC = public()
CLASSES = {name: x for name, x in PUBLIC.items() if inspect.isclass(x)}
OBJECTS = {"formulas": gm.formulas}  # an instance, whose class is not public
FUNCTIONS = {name: x for name, x in PUBLIC.items() if name not in {*CLASSES, *OBJECTS}}
METHODS = {f"{x}.{name}": f for x, cls in CLASSES.items() for name, f in methods_of(cls).items()}
CALLABLES = FUNCTIONS | METHODS
