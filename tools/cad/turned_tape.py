"""The tape of a surface of revolution: the polynomials of a NURBS curve, then the rotation."""

from dataclasses import replace

import numpy as np

from ...generated.faces import revolution_jet
from ...generated.vectors import Vector
from ...runtime.base.formula_calls import python_function
from ...runtime.surface.nurbs import Nurbs
from ...runtime.surface.traced import Traced
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import TapeWriter

# The curve does not depend on u: there is one span in u, which contains all angles of faces.
ALL_ANGLES = np.array([-64.0, 64.0])


def turned_tape(curve: Nurbs) -> Tape | None:
    """Return the tape of a surface of revolution: a curve, turned about the z axis by u.

    The curve is the line v = 0 of a NURBS; u of the NURBS is v of the surface. None means that the
    NURBS has no tape.
    """
    along = replace(
        curve,
        degrees=(0, curve.degrees[0]),
        knots=(ALL_ANGLES, curve.knots[0]),
        points=np.ascontiguousarray(curve.points[:, 0][None]),
        domain=((-64.0, 64.0), curve.domain[0]),
        periodic=(False, curve.periodic[0]),
        creases=((), curve.creases[0]),
    )
    tape = along.tape()
    if tape is None:
        return None
    writer = TapeWriter()
    point = Vector._make(Traced(writer, x) for x in writer.replay(tape))
    angle, none = Traced(writer, writer.write("u")), Vector(0.0, 0.0, 0.0)
    turned = python_function(revolution_jet)(point, none, none, angle.cos(), angle.sin())[0]
    return writer.tape([x.row for x in turned])
