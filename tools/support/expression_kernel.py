"""The kernel of a user's expression: interpreted for few normals, compiled once that pays."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numba.core import config as numba_config
from numpy.typing import NDArray

from ...runtime.machine_code.jit import jit

__all__ = ["ExpressionKernel", "kernel_of"]

config: Any = numba_config  # Numba makes its attributes at run time
# Interpreting takes 10 µs a normal, compiling 1 s, and 4 s when Numba's compiler is not loaded yet.
MOST_INTERPRETED = 50_000
# NumPy's names of functions of `math`, where they differ.
OF_NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"}


class ExpressionKernel:
    """Evaluates a support function at normals; both ways give the same values, bit for bit.

    `source` is a module that defines `evaluate`, as `symbolic.expression.kernel_source` writes it.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self._interpreted = 0  # normals so far

    def __call__(
        self,
        normals: NDArray[np.float64],
        inside: NDArray[np.bool_],
        points: NDArray[np.float64],
        hessians: NDArray[np.float64],
    ) -> None:
        """Fill the last three arrays for each of the normals."""
        self._interpreted += len(normals)
        pays = self._interpreted > MOST_INTERPRETED and not config.DISABLE_JIT
        kernel = self._compiled if pays else self._interpreter
        with np.errstate(all="ignore"):
            kernel(normals, inside, points, hessians)

    @cached_property
    def _interpreter(self) -> Callable[..., None]:
        return self._defined(FUNCTIONS)

    @cached_property
    def _compiled(self) -> Callable[..., None]:
        function = self._defined(math)
        # By this name its machine code is kept, and found by other processes.
        function.__qualname__ = f"evaluate_{hashlib.sha256(self.source.encode()).hexdigest()}"
        return jit(function)

    def _defined(self, functions: object) -> Callable[..., None]:
        namespace: dict[str, Any] = {"__name__": __name__}  # whose kernel it is
        exec(compile(self.source, "<support function>", "exec"), namespace)
        namespace["math"] = functions
        return namespace["evaluate"]


@lru_cache(maxsize=128)
def kernel_of(source: str) -> ExpressionKernel:
    """Return the kernel of a source, the same one for the same source."""
    return ExpressionKernel(source)


def _total(name: str, function: Callable[..., Any]) -> Callable[..., np.float64]:
    """Return a function of `math` that returns what C does where Python's raises an error."""
    everywhere = getattr(np, OF_NUMPY.get(name, name), None)

    def evaluate(*arguments: float) -> np.float64:
        try:
            return np.float64(function(*arguments))
        except (ValueError, OverflowError):
            return np.float64(np.nan if everywhere is None else everywhere(*arguments))

    return evaluate


FUNCTIONS = SimpleNamespace(
    **{name: _total(name, x) if callable(x) else x for name, x in vars(math).items()}
)
