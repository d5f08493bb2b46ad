"""All formulas by name; the error for an unknown name lists similar ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ...runtime.base import bridge
from ...runtime.base.checks import known_name

if TYPE_CHECKING:
    from ...runtime.base.bridge import Formula


class Formulas(Mapping[str, "Formula"]):
    """The formulas of `gaussmap.symbolic` by name; SymPy is loaded at first use.

    `formulas[name]` raises UnknownNameError, with similar names, if the name is unknown.
    """

    @cached_property
    def _formulas(self) -> Mapping[str, Formula]:
        return bridge.formulas()

    def __getitem__(self, name: str) -> Formula:
        """Return a formula; UnknownNameError if the name is unknown."""
        return self._formulas[known_name(name, tuple(self), "formula", "gaussmap formulas")]

    def __contains__(self, name: object) -> bool:
        """Return whether a formula has this name."""
        return isinstance(name, str) and name in self._formulas

    def get(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - as in Mapping
        """Return a formula, or `default` if no formula has this name."""
        return self._formulas.get(name, default)

    def __iter__(self) -> Iterator[str]:
        """Return the names in the order of the sections."""
        return iter(self._formulas)

    def __len__(self) -> int:
        """Return the number of formulas."""
        return len(self._formulas)

    def __reduce__(self) -> str:
        """Return the name of the only instance; copies and pickles refer to this instance."""
        return "formulas"

    def __repr__(self) -> str:
        return f"Formulas({len(self)} formulas)"


formulas = Formulas()
