"""The regular icosahedron, exactly: its corners, edges and faces, and a frame for each face."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import sympy as sp
from sympy.polys.matrices import DomainMatrix

__all__ = [
    "CORNERS",
    "EDGES",
    "FACES",
    "PHI",
    "barycentric",
    "face_radius",
    "frame",
    "golden_parts",
]

PHI = sp.GoldenRatio
# The cyclic permutations of (0, ±1, ±φ).
CORNERS = [
    sp.Matrix(corner)
    for corners in (
        [(0, i, j * PHI) for i in (-1, 1) for j in (-1, 1)],
        [(i, j * PHI, 0) for i in (-1, 1) for j in (-1, 1)],
        [(i * PHI, 0, j) for i in (-1, 1) for j in (-1, 1)],
    )
    for corner in corners
]


def _are_near(i: int, j: int) -> bool:
    apart = CORNERS[i] - CORNERS[j]
    return sp.simplify((apart.dot(apart) - 4).rewrite(sp.sqrt)) == 0


EDGES = [pair for pair in combinations(range(12), 2) if _are_near(*pair)]
FACES = [
    (i, j, k) for i, j, k in combinations(range(12), 3) if {(i, j), (i, k), (j, k)} <= {*EDGES}
]


def golden_parts(corner: sp.Matrix) -> list[tuple[int, int]]:
    """Return the coordinates a + b φ of a corner as pairs (a, b)."""
    return [(int(x.coeff(PHI, 0)), int(x.coeff(PHI, 1))) for x in corner]


@cache
def barycentric(face: tuple[int, int, int]) -> sp.Matrix:
    """Return the matrix that gives α, β, γ of n = α i + β j + γ k, with the corners of a face."""
    corners = sp.Matrix.hstack(*(CORNERS[x] for x in face)).applyfunc(lambda x: x.rewrite(sp.sqrt))
    # In the field of the numbers a + b √5, which is much faster than with expressions.
    return DomainMatrix.from_Matrix(corners, extension=True).to_field().inv().to_Matrix()


def frame(face: tuple[int, int, int]) -> sp.Matrix:
    """Return the linear map (3, 3) to 2γ − h, 2β − h and h = α + β + γ.

    Divided by h, the first two reach from −1 to 1 on the face, and count the columns and the rows
    of its lattice; h is the third, the height.
    """
    alpha, beta, gamma = (barycentric(face).row(k) for k in range(3))
    height = alpha + beta + gamma
    return sp.Matrix.vstack(2 * gamma - height, 2 * beta - height, height)


def face_radius() -> sp.Expr:
    """Return the tangent of the angle between the middle of a face and its corners.

    Of all small triangles that cut a face into ν² the one in its middle looks largest from the
    centre; its angle has a tangent ν times smaller.
    """
    corners = [CORNERS[x].applyfunc(lambda x: x.rewrite(sp.sqrt)) for x in FACES[0]]
    middle = (corners[0] + corners[1] + corners[2]) / 3
    return sp.radsimp(
        sp.sqrt(
            sp.radsimp(
                sp.expand((corners[0] - middle).dot(corners[0] - middle) / middle.dot(middle))
            )
        )
    )
