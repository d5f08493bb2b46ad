"""Users' formulas as compiled functions, printed by the same code as the files in generated/."""

from __future__ import annotations

import linecache
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .emit import function, named_tuples
from .formula import Formula
from .loops import array_function, row_shapes
from .simplify import StraightLine, straight_line

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

PREAMBLE = "import math\nfrom typing import NamedTuple\n"


def compiled(formula: Formula) -> CompiledFormula:
    """Return a formula as a function of arrays that Numba compiles; all stages can be inspected.

    It is printed by the same code as the functions in `generated/`. Compilation happens at the
    first call.

    Parameters
    ----------
    formula : Formula
        Inputs, named terms, outputs and a sentence; see `Formula.build`.

    Returns
    -------
    CompiledFormula
        The function. Call it with one array for each input.

    Raises
    ------
    TypeError
        For anything but a Formula.
    ValueError
        If the formula uses a name of its loop, such as "row", or takes or returns all vectors of a
        patch or an arc.
    NotImplementedError
        For a function of SymPy that cannot be printed.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import sympy as sp
    >>> K, H = sp.symbols("K H", real=True)
    >>> energy = gm.symbolic.Formula.build(
    ...     "bending_energy",
    ...     "The density $B$ of the bending energy: the sum of the squared principal curvatures.",
    ...     inputs=[K, H],
    ...     outputs=[("B", 4 * H**2 - 2 * K)],
    ... )
    >>> measure = gm.symbolic.compiled(energy)
    >>> measure([1.0, -1.0], [1.0, 0.0])
    array([2., 2.])
    >>> measure.operations, measure.latex.splitlines()[1]
    ((4, 4), 'B &= 4 H^{2} - 2 K')

    """
    return CompiledFormula(formula)


class CompiledFormula:
    """A formula and its stages, from the derivation to the compiled function; made by `compiled`.

    Attributes
    ----------
    formula : Formula
        The derived formula, in the notation of vectors.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> d, e = gm.symbolic.vectors("de")
    >>> area = gm.symbolic.Formula.build(
    ...     "area_vector",
    ...     "The cross product $N$ of two vectors.",
    ...     inputs=[d, e],
    ...     outputs=[("N", gm.symbolic.Cross(d, e))],
    ... )
    >>> cross = gm.symbolic.compiled(area)
    >>> cross
    CompiledFormula(area_vector: d, e -> N)
    >>> cross(np.eye(3), [0, 0, 1])
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  0.]])
    >>> cross.operations
    (9, 9)
    >>> print(cross.source.splitlines()[1])
    def area_vector(d, e):
    >>> cross.simplified.assignments[0]
    (N_x, d_y*e_z - d_z*e_y)

    """

    def __init__(self, formula: Formula) -> None:
        if not isinstance(formula, Formula):
            raise TypeError(f"compiled takes a Formula, not {type(formula).__name__}.")
        self.formula = formula
        self._inputs, self._outputs = row_shapes(formula)
        self._loop_source  # noqa: B018 - raises for names that clash

    def __repr__(self) -> str:
        inputs, outputs = map(", ".join, (self._inputs, self._outputs))
        return f"CompiledFormula({self.formula.name}: {inputs} -> {outputs})"

    @cached_property
    def simplified(self) -> StraightLine:
        """The assignments in components, with common subexpressions computed once."""
        return straight_line(self.formula)

    @property
    def operations(self) -> tuple[int, int]:
        """The number of operations of the formula as written, and of its function as it runs."""
        return self.simplified.operations_before, self.simplified.operations_after

    @property
    def latex(self) -> str:
        """The definitions as an `aligned` block of LaTeX."""
        return self.formula.latex()

    @cached_property
    def source(self) -> str:
        """The Python source of the function of one set of inputs, as in `generated/`."""
        return function(self.formula)

    @cached_property
    def scalar_function(self) -> Callable[..., Any]:
        """The function of one set of inputs, which Numba inlines into its callers.

        Vectors are tuples of three numbers, as in `generated/vectors.py`.
        """
        import numba

        inline = numba.njit(inline="always", nogil=True, error_model="numpy", fastmath=False)
        return self._made(f"{named_tuples()}\n\n\n{self.source}\n", {"inline": inline})

    @cached_property
    def array_function(self) -> Callable[..., Any]:
        """The compiled function of arrays (k, …) of inputs, which fills the output arrays."""
        import numba

        loop = self._made(self._loop_source, {})
        return numba.njit(nogil=True, error_model="numpy", fastmath=False)(loop)

    def __call__(self, *inputs: ArrayLike) -> Any:  # noqa: ANN401 - one array or several
        """Return an array for each output, from arrays of the inputs, which broadcast together.

        Scalars are (…), vectors (…, 3) and Hessians (…, 3, 3).
        """
        import numpy as np

        if len(inputs) != len(self._inputs):
            raise TypeError(
                f"{self.formula.name} takes {len(self._inputs)} arrays, "
                f"{', '.join(self._inputs)}, not {len(inputs)}."
            )
        arrays = [np.asarray(x, dtype=np.float64) for x in inputs]
        widths = list(self._inputs.values())
        for name, array, width in zip(self._inputs, arrays, widths, strict=True):
            if width and array.shape[-len(width) :] != width:
                shape = ", ".join(("…", *map(str, width)))
                raise ValueError(f"{name} must have the shape ({shape}), not {array.shape}.")
        heads = [x.shape[: x.ndim - len(width)] for x, width in zip(arrays, widths, strict=True)]
        head = np.broadcast_shapes(*heads)
        rows = [_rows(x, head, width) for x, width in zip(arrays, widths, strict=True)]
        outputs = list(self._outputs.values())
        found = [np.empty((len(rows[0]), *width)) for width in outputs]
        self.array_function(*rows, *found)
        result = [x.reshape(head + width)[()] for x, width in zip(found, outputs, strict=True)]
        return result[0] if len(result) == 1 else tuple(result)

    @cached_property
    def _loop_source(self) -> str:
        return array_function(self.formula, self.formula.inputs)

    def _made(self, source: str, names: dict[str, Any]) -> Callable[..., Any]:
        """Run the source of a function and return the function; debuggers can show the source."""
        text = f"{PREAMBLE}\n\n{source}"
        place = f"<formula {self.formula.name} {id(self)} {len(text)}>"
        linecache.cache[place] = (len(text), None, text.splitlines(keepends=True), place)
        exec(compile(text, place, "exec"), names)
        return names[self.formula.name]


def _rows(
    array: NDArray[np.float64], head: tuple[int, ...], width: tuple[int, ...]
) -> NDArray[np.float64]:
    """Return a broadcast array with one row for each evaluation."""
    import numpy as np

    return np.ascontiguousarray(np.broadcast_to(array, head + width)).reshape(-1, *width)
