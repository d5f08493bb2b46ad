"""The regular icosahedron, exactly: its corners, edges and faces, and a frame for each face."""

import math
from functools import cache
from itertools import combinations
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

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
    coordinates: list[Any] = corner.flat()
    return [(int(x.coeff(PHI, 0)), int(x.coeff(PHI, 1))) for x in coordinates]


@cache
def barycentric(face: tuple[int, int, int]) -> sp.Matrix:
    """Return the matrix that maps n to α, β, γ with n = α i + β j + γ k, for corners i, j, k."""
    corners = sp.Matrix.hstack(*(CORNERS[x] for x in face)).applyfunc(lambda x: x.rewrite(sp.sqrt))
    # Arithmetic in the field of numbers a + b √5 is much faster than with expressions.
    return DomainMatrix.from_Matrix(corners, extension=True).to_field().inv().to_Matrix()


def frame(face: tuple[int, int, int]) -> sp.Matrix:
    """Return the matrix (3, 3) that maps a normal to 2γ − h, 2β − h and h = α + β + γ.

    α, β, γ are those of `barycentric`. Divided by h, the first two values range from −1 to 1 on the
    face, and determine columns and rows of its lattice.
    """
    alpha, beta, gamma = (barycentric(face).row(k) for k in range(3))
    height = alpha + beta + gamma
    return sp.Matrix.vstack(2 * gamma - height, 2 * beta - height, height)


def face_radius() -> sp.Expr:
    """Return the tangent of the angle between the middle of a face and its corners.

    Among the ν² small triangles of a face, the middle one subtends the largest angle at the centre;
    the tangent of that angle is ν times smaller.
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


def tables() -> dict[str, tuple[str, Any]]:
    """Return the tables for kernels, by name; each is a sentence and correctly rounded numbers."""
    sides = [tuple(combinations(face, 2)) for face in FACES]
    owners = [next(k for k, pairs in enumerate(sides) if edge in pairs) for edge in EDGES]
    holders = [next(k for k, face in enumerate(FACES) if corner in face) for corner in range(12)]
    coordinates = [_floats(barycentric(face)) for face in FACES]
    frames = [_floats(frame(face)) for face in FACES]
    corners = ([CORNERS[x] for x in face] for face in FACES)
    lines = [[i, j - i, k - i] for i, j, k in corners]
    return {
        "PHI": ("The golden ratio φ.", _float(PHI)),
        "FACE_RADIUS": (
            "The tangent of the angle between the middle of a face and its corners.",
            _float(face_radius()),
        ),
        "LINES": (
            "For each face its first corner and the steps from there to the two others: "
            "x, y, z as a + b φ, each as a, b.",
            [[[float(y) for x in golden_parts(v) for y in x] for v in line] for line in lines],
        ),
        "POSITIONS": ("The corners.", [[_float(x) for x in corner] for corner in CORNERS]),
        "FACES": ("The numbers of the corners of each face.", FACES),
        "CORNER_PLACES": (
            "One face of each corner, and t/ν and s/ν of the corner on it: the points of frequency "
            "ν on a face are (ν − s − t, s, t).",
            [
                (k, *((0, 0), (0, 1), (1, 0))[FACES[k].index(corner)])
                for corner, k in enumerate(holders)
            ],
        ),
        "EDGE_PLACES": (
            "One face of each edge, and the side of it: t = 0, s = 0 or s + t = ν.",
            [(k, sides[k].index(edge)) for edge, k in zip(EDGES, owners, strict=True)],
        ),
        "BARYCENTRIC": (
            "Maps of a normal to α, β, γ, with which the corners of a face are added to give it.",
            coordinates,
        ),
        "LENGTHS": ("The lengths of their rows.", [[*_lengths(x)] for x in coordinates]),
        "FRAMES": ("Maps of a normal to 2γ − h, 2β − h and h = α + β + γ.", frames),
        "STRETCHES": ("The largest lengths of their rows.", [max(_lengths(x)) for x in frames]),
    }


def _float(x: Any) -> float:  # noqa: ANN401 - entries of matrices have no types
    return float(x.evalf(40))


def _floats(matrix: sp.Matrix) -> list[list[float]]:
    return [[_float(x) for x in matrix.row(k)] for k in range(matrix.rows)]


def _lengths(matrix: list[list[float]]) -> list[float]:
    return [math.hypot(*row) for row in matrix]
