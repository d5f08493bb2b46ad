"""The compilation of the functions of this package, and the cache of their machine code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import config as numba_config
from numba.extending import intrinsic

from ...generated.vectors import inline
from ..base import compiling  # noqa: F401 - installs the notice of compilation
from .cache import KernelCache
from .linking import KernelCompiler, PartCompiler, without_literals

__all__ = ["inline", "jit", "long_vectors", "loop"]

Function = TypeVar("Function", bound=Callable[..., Any])

config: Any = numba_config  # Numba creates its attributes at run time
# Compiled functions are called from Python or from one another, never from C, and do not count
# references.
OPTIONS: dict[str, Any] = {
    "nogil": True, "error_model": "numpy", "fastmath": False, "no_cfunc_wrapper": True,
    "_nrt": False,
}  # fmt: skip


def loop(function: Function) -> Function:
    """Compile a function that kernels call, once and separately from them.

    Use it for functions that are long or have several callers. They allocate no memory: arrays come
    from the caller. Use `inline` for short functions, which are copied into their callers.
    """
    options = {"pipeline_class": PartCompiler, "no_cpython_wrapper": True, **OPTIONS}
    return without_literals(numba.njit(**options)(function))  # pyright: ignore


def jit(function: Function) -> Function:
    """Compile a kernel at its first call from Python, unless its machine code is cached.

    Kernels allocate no memory: all arrays are arguments. They are called from Python only:
    machine code of the package cannot be linked into other kernels.
    """
    kernel: Any = numba.njit(pipeline_class=KernelCompiler, **OPTIONS)(function)
    if not config.DISABLE_JIT:
        kernel._cache = KernelCache(function)
    return kernel


def _long_vectors(_: object) -> tuple[Any, Callable[..., Any]]:
    """Request the longest vectors of the processor in the calling function.

    By default, LLVM uses half of their length. The results are the same.
    """

    def lowered(context: Any, builder: Any, *_: object) -> Any:
        # llvmlite's own `add` does not accept attributes with values.
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), lowered


long_vectors: Any = (lambda: None) if config.DISABLE_JIT else intrinsic(_long_vectors)
