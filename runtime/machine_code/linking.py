"""Linking of kernels: each part is optimised once, and compiled to machine code with the kernel.

Numba optimises a function together with all functions that it calls, and makes machine code of all
of them, at each level of calls: a function that a kernel calls through three others is optimised
four times. Here a part is optimised once, on its own, together with small parts that may be
inlined; a kernel is linked with the parts that it needs. The results are the same.

This overrides methods of Numba that are not public. If a version of Numba lacks them, it compiles
in its own way, which takes twice as long.
"""

from __future__ import annotations

from collections import Counter
from itertools import islice
from typing import Any

from llvmlite.binding import Linkage
from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.environment import lookup_environment

# The private attributes of Numba's code libraries that are used here.
PRIVATE = (
    "_codegen", "_final_module", "_finalized", "_linking_libraries", "_reload_init",
    "_finalize_final_module", "_get_module_for_linking", "_optimize_final_module",
    "_raise_if_finalized",
)  # fmt: skip
# The largest number of instructions of functions offered for inlining. LLVM decides, with a lower
# limit: about 50, more for functions of many arguments.
SMALL = 200


class Part(JITCodeLibrary):
    """The code of a function that kernels call."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.called: dict[Part, None] = {}
        """All parts that it needs, each before those that call it."""
        self.offered: Any = None
        """The same code for callers to inline; None if it is too long."""

    @property
    def codegen(self) -> Any:
        """The owner of the code: the part itself, as the execution engine takes only kernels."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: kernels set the variable with the given name, for all of their parts."""

    def finalize(self) -> None:
        """Optimise this function, together with small parts that it may inline."""
        self._raise_if_finalized()
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            if not isinstance(library, Part):
                self._final_module.link_in(library._get_module_for_linking(), preserve=True)
                continue
            self.called.update(library.called)
            self.called[library] = None
            if library.offered is not None:
                self._final_module.link_in(library.offered, preserve=True)
        self._optimize_final_module()
        self._finish()

    def _finish(self) -> None:
        self._finalized = True
        if all(map(_is_small, self._final_module.functions)):
            self.offered = self._final_module.clone()
            for function in self._final_module.functions:
                if not function.is_declaration:
                    own = self.offered.get_function(function.name)
                    own.linkage = Linkage.available_externally


class Kernel(Part):
    """The code of a kernel, with the code of all parts that it needs."""

    def _finish(self) -> None:
        # Parts are linked before the parts that they call, so that code without callers is left
        # out.
        for part in reversed(self.called):
            self._final_module.link_in(part._get_module_for_linking(), preserve=True)
        self._final_module.verify()
        self._finalize_final_module()
        owner: Any = self._codegen
        for variable in self._final_module.global_variables:
            environment = lookup_environment(variable.name)
            if environment is not None:
                owner.set_env(variable.name, environment)


class PartCompiler(Compiler):
    """The compiler of parts."""

    library = Part

    def compile_extra(self, func: Any) -> Any:
        """Compile a function into a `library`, if Numba's code libraries have all of PRIVATE."""
        name = f"{func.__module__}.{func.__qualname__}"
        library = self.library(self.state.targetctx.codegen(), name)
        if all(hasattr(library, name) for name in PRIVATE):
            library.enable_object_caching()
            self.state.library = library
        return super().compile_extra(func)


class KernelCompiler(PartCompiler):
    """The compiler of kernels."""

    library = Kernel


def copies_in(library: Any) -> list[str]:
    """Return the names of the parts that a kernel needs for several sets of argument types."""
    names = Counter(part.name for part in getattr(library, "called", ()))
    return sorted(name for name, count in names.items() if count > 1)


def without_literals(part: Any) -> Any:
    """Make Numba compile one copy of a part for all integers, not one for each literal."""
    if hasattr(part, "_compiler"):  # absent if compilation is switched off
        fold = part._compiler.fold_argument_types

        def folded(*arguments: Any) -> Any:
            signature, kinds = fold(*arguments)
            return signature, tuple(map(types.unliteral, kinds))

        part._compiler.fold_argument_types = folded
    return part


def _is_small(function: Any) -> bool:
    if function.is_declaration:
        return True
    instructions = (x for block in function.blocks for x in block.instructions)
    return next(islice(instructions, SMALL, None), None) is None
