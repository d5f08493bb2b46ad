"""The ways that are judged: the paper's method in closed form, gaussmap's densities, and others."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import gaussmap as gm
from gaussmap.tools.density.request import checked_request
from gaussmap.tools.sampling.sample import sample_and_normals

from ..peers.cad import gmsh_by_curvature, opencascade_by_angle
from ..peers.forms import Array, ClosedForm
from ..peers.meshes import open3d_farthest, open3d_poisson, pymeshlab_poisson
from ..peers.peer import Peer, Points, Work

ROUNDS = 3  # of timing, and of judging Poisson disks; slow ways are timed once


@cache
def normals_of_gauss(form: ClosedForm, count: int) -> Array:
    """Return the normals that gaussmap itself chooses for density="gauss"."""
    request = checked_request(None, count, None, None, "gauss", None)
    return sample_and_normals(form.surface, request, cells=None, threads=None, progress=False)[1]


def perfect(form: ClosedForm, count: int) -> Work:
    """Prepare the points with exactly the normals that gaussmap chooses for this count."""
    normals = normals_of_gauss(form, count)
    form.preimages(normals[:1])  # raises NotImplementedError where there is no closed form
    return lambda: form.evaluate(*form.preimages(normals))


def icosahedral(form: ClosedForm, count: int) -> Work:
    """Prepare the points at the normals of an icosphere, with a number nearest to `count`."""

    def came(frequency: int) -> int:
        return len(form.preimages(gm.icosphere(frequency))[0])

    frequency = 1
    while came(frequency + 1) < count:
        frequency += 1
    frequency = min((frequency, frequency + 1), key=lambda x: abs(came(x) - count))
    normals = gm.icosphere(frequency)
    return lambda: form.evaluate(*form.preimages(normals))


def sampled(density: str) -> Callable[[ClosedForm, int], Work]:
    """Return a function that prepares `gm.sample` for a surface; each call fits a spline."""

    def prepare(form: ClosedForm, count: int) -> Work:
        surface = form.surface

        def work() -> Points:
            samples = gm.sample(surface, count=count, density=density)
            return samples.points, samples.normals

        return work

    return prepare


def own(title: str, density: str) -> Peer:
    """Return one way of gaussmap."""
    return Peer(title, density, "gaussmap", sampled(density), 0, ROUNDS)


PERFECT = Peer("the paper's method, exact", "", "numpy", perfect, 0, rounds=ROUNDS)
ICOSAHEDRAL = Peer("the same, icosahedral normals", "", "numpy", icosahedral, 0, rounds=ROUNDS)
GAUSS = own("**gauss**", "gauss")
BALANCED = own("**balanced**", "balanced")
ALIGNED = own("**aligned**", "aligned")
UNIFORM = own("**uniform**", "uniform")
DENSITIES = (BALANCED, ALIGNED, GAUSS, UNIFORM)
POISSON = (
    Peer("Open3D, Poisson disk", "", "open3d", open3d_poisson, 0, ROUNDS),
    Peer("PyMeshLab, Poisson disk", "", "pymeshlab", pymeshlab_poisson, 0, ROUNDS),
)
FARTHEST = Peer("Open3D, farthest point", "", "open3d", open3d_farthest, 0, rounds=1)
GMSH = Peer("Gmsh, curvature size", "", "gmsh", gmsh_by_curvature, 0, rounds=1)
OPENCASCADE = Peer("Open CASCADE, angular deflection", "", "OCP", opencascade_by_angle, 0, rounds=1)
WAYS = (PERFECT, ICOSAHEDRAL, *DENSITIES, *POISSON, FARTHEST, GMSH, OPENCASCADE)
