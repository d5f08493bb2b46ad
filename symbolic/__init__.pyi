"""The public names and where they are defined; `__init__.py` loads them from here."""

from .bezier import BezierTriangle as BezierTriangle
from .catalogue import formulas as formulas
from .formula import Formula as Formula
from .notation import Cross as Cross
from .notation import Det as Det
from .notation import Dot as Dot
from .notation import vectors as vectors
from .numba_function import CompiledFormula as CompiledFormula
from .numba_function import compiled as compiled
