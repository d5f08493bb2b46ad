"""`Named`: the name or formula of a surface or part, and the options with which it is made."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any, Self

from ...runtime.base.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True)
class Named:
    """The name of a surface, and the options of `gaussmap sample` for it, None if not given.

    Raises
    ------
    InputError
        For options that do not go together.

    """

    surface: str | None = None
    formula: tuple[str, str, str] | None = None
    domain: tuple[str, str, str, str] | None = None
    set: tuple[tuple[str, float], ...] = ()
    spacing: tuple[float, float] | None = None
    periodic: str | None = None
    nodata: float | None = None
    cells: tuple[int, int] | None = None
    tolerance: float | None = None
    band: int | None = None
    x: str | None = None
    y: str | None = None
    crs: str | None = None
    source_crs: str | None = None
    origin: tuple[float, float] | None = None
    kind: tuple[str, ...] = ()
    name: str | None = None
    faces: str | None = None
    unit: str | None = None
    time_limit: float | None = None
    memory_limit: float | None = None
    quiet: bool = False

    def __post_init__(self) -> None:
        if self.domain is not None and self.formula is None:
            raise InputError("--domain goes with --formula only.")
        if self.tolerance is not None and self.cells is not None:
            raise InputError("--tolerance and --cells do not go together; give one of them.")

    @classmethod
    def of(cls, options: SimpleNamespace) -> Self:
        """Return the `Named` of the options of a command; other options are ignored."""
        known = vars(options)
        return cls(**{x.name: known[x.name] for x in fields(cls) if x.name in known})

    def refuse(self, names: Iterable[str], reason: str) -> None:
        """Raise InputError if any of these options is given; {} in `reason` stands for the surface.

        The message names the option, and says why it does not apply to this surface.
        """
        for name in names:
            if name in self.given():
                source = f"'{self.surface or 'a formula'}'"
                raise InputError(f"--{name.replace('_', '-')} {reason}".replace("{}", source))

    def given(self) -> dict[str, Any]:
        """Return the given options, by name."""
        values = {x.name: (getattr(self, x.name), x.default) for x in fields(self)}
        return {name: value for name, (value, default) in values.items() if value != default}
