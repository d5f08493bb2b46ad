"""`formulas`: every formula by its name."""

from collections.abc import Mapping
from types import MappingProxyType

from . import (
    curve,
    elementary,
    faces,
    gaussian_image,
    jet,
    mesh,
    offset,
    patch,
    proved,
    rational,
    spline,
    support,
    taylor,
)
from .formula import Formula

formulas: Mapping[str, Formula] = MappingProxyType(
    {
        formula.name: formula
        for module in (
            patch,
            offset,
            gaussian_image,
            spline,
            support,
            jet,
            rational,
            taylor,
            elementary,
            proved,
            faces,
            mesh,
            curve,
        )
        for formula in module.FORMULAS
    }
)
