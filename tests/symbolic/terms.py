"""Numbers that say how often the terms they are made of have been rounded."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any


@dataclass(frozen=True)
class Term:
    """An exact value, the sum of the moduli of the terms it is made of, and their roundings."""

    value: Fraction
    size: Fraction
    roundings: int

    @classmethod
    def of(cls, number: Any) -> Term:
        return (
            number if isinstance(number, Term) else cls(Fraction(number), abs(Fraction(number)), 0)
        )

    def __add__(self, other: Any) -> Term:
        other = Term.of(other)
        roundings = max(self.roundings, other.roundings) + 1
        return Term(self.value + other.value, self.size + other.size, roundings)

    def __mul__(self, other: Any) -> Term:
        other = Term.of(other)
        roundings = self.roundings + other.roundings + 1
        return Term(self.value * other.value, self.size * other.size, roundings)

    def __truediv__(self, other: Any) -> Term:
        other = Term.of(other)
        quotients.append(other)
        roundings = self.roundings + other.roundings + 1
        size = self.size * other.size / other.value**2
        return Term(self.value / other.value, size, roundings)

    def __neg__(self) -> Term:
        return Term(-self.value, self.size, self.roundings)

    def __sub__(self, other: Any) -> Term:
        return self + -Term.of(other)

    def __rtruediv__(self, other: Any) -> Term:
        return Term.of(other) / self

    __radd__ = __add__
    __rmul__ = __mul__


# The denominators so far.
quotients: list[Term] = []
