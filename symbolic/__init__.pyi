"""The public names and where they are defined; `__init__.py` loads them from here."""

from .bezier import BezierTriangle as BezierTriangle
from .catalogue import formulas as formulas
from .formula import Formula as Formula
