"""A formula: look at it, change it, and have its function written again.

This needs the installed package only. To change a formula of gaussmap itself, clone the repository,
edit `symbolic/`, and run `make generate`.
"""

import math

import gaussmap as gm
import numba
import numpy as np
import sympy as sp
from gaussmap.generated.vectors import Patch
from gaussmap.symbolic import Formula
from gaussmap.symbolic.emit import function
from gaussmap.symbolic.notation import Dot

formula = gm.formulas["support_function"]
print(formula.sentence, formula.source)
print(formula.latex())

# The support function of the offset at the distance R is larger by R |n|.
n, R = formula.inputs[-1], sp.Symbol("R", real=True)
changed = Formula.build(
    "offset_support_function",
    "The support function of the offset of a quadratic patch at the distance $R$.",
    inputs=[*formula.inputs, R],
    terms=[(symbol.name, value) for symbol, value in formula.definitions],
    outputs=[("h_R", formula.outputs[0] + R * sp.sqrt(Dot(n, n)))],
)
print(changed.latex())
source = function(changed)
print(source)

# --- Is it true? At the normal of a point x(u,v) of the patch it is n·x + R. ---

names = {"math": math, "inline": numba.njit}
exec(source, names)  # the text can also be put into a module of your own
rng = np.random.default_rng(1)
for _ in range(100):
    a, b, c, d, e, p = rng.normal(size=(6, 3))
    u, v, distance = rng.normal(size=3)
    position = a * u**2 / 2 + b * u * v + c * v**2 / 2 + d * u + e * v + p
    normal = np.cross(a * u + b * v + d, b * u + c * v + e)
    normal /= np.linalg.norm(normal)
    found = names["offset_support_function"](
        Patch(*map(tuple, (a, b, c, d, e, p))), tuple(normal), distance
    )
    A, B, C, P, Q = (np.abs(normal) @ np.abs(x) for x in (a, b, c, d, e))
    D = abs((normal @ a) * (normal @ c) - (normal @ b) ** 2)
    terms = (P * (B * Q + C * P) + Q * (B * P + A * Q)) / D * (1 + (A * C + B * B) / D)
    # Fifty operations, each with a relative error of half an eps of the largest terms.
    bound = 25 * np.finfo(float).eps * (terms + np.abs(normal) @ np.abs(p) + abs(distance))
    assert abs(found - (normal @ position + distance)) < bound
print("100 patches: the offset has the support function n·x + R")
