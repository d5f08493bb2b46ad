"""Meshes of splines of nets: closed where the nets are, with normals that smooth joints share."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.spline.nets import NetSpline
from gaussmap.tools.meshes.creased import CreasedMesh

from ...nets import bezier
from ...refusals import refused
from ...shapes import Array, unit
from .test_nets import octants, powell_sabin

PARTS = [1, 3]


def of_fit(name: str) -> NetSpline:
    return gm.Spline.from_nets(gm.fit(name, (8, 6)).control_nets, name=name)


def from_patches(spline: NetSpline, mesh: CreasedMesh, parts: int) -> Array:
    """Return how far the corners of each triangle are from points of the patch that it is of."""
    n = parts + 1
    places = np.array([(i, j, parts - i - j) for i in range(n) for j in range(n - i)]) / parts
    points = bezier(spline.control_nets[mesh.face_index][:, None], places)[0]
    corners = mesh.vertices[mesh.triangles]
    return np.linalg.norm(corners[:, :, None] - points[:, None], axis=3).min(axis=2)


@pytest.mark.parametrize("parts", PARTS)
@pytest.mark.parametrize(("name", "characteristic"), [("torus", 0), ("sphere", 2)])
def test_closed_nets_have_closed_meshes(name: str, characteristic: int, parts: int) -> None:
    spline = of_fit(name)
    mesh = spline.mesh(parts)
    assert mesh.closed  # and so all triangles have one orientation
    assert mesh.euler_characteristic == characteristic
    assert len(mesh.triangles) == spline.patches * parts**2 - (16 * parts if characteristic else 0)
    assert len(mesh.split.vertices) == len(mesh.vertices)  # no creases, nor at poles
    assert np.abs(mesh.corner_normals - mesh.normals[mesh.triangles]).max() < 1e-14
    assert from_patches(spline, mesh, parts).max() < 1e-14
    assert mesh.summary().startswith(f"{len(mesh.vertices):,} vertices, {len(mesh.triangles):,} tr")


@pytest.mark.parametrize("parts", PARTS)
def test_normals_are_those_of_the_surface(parts: int) -> None:
    """Those of a fitted torus are off by its misfit."""
    spline = gm.fit("torus", (24, 24))
    mesh = gm.Spline.from_nets(spline.control_nets).mesh(parts)
    x, y, z = mesh.vertices.T
    outwards = unit(np.stack([x - x / np.hypot(x, y), y - y / np.hypot(x, y), z], axis=1))
    angles = np.degrees(np.arccos(np.clip((outwards * mesh.normals).sum(axis=1), -1.0, 1.0)))
    assert angles.max() < 1.5 * spline.misfit.angle
    assert np.abs(np.linalg.norm(mesh.normals, axis=1) - 1.0).max() < 1e-14


@pytest.mark.parametrize("parts", PARTS)
def test_powell_sabin_splines_are_open(parts: int) -> None:
    nets = powell_sabin(30, 3, 0.15)
    spline = gm.Spline.from_nets(nets)
    mesh = spline.mesh(parts)
    assert mesh.euler_characteristic == 1
    border = 3 * len(nets) - 2 * len(spline.joints.patches)
    assert len(mesh.boundary_edges) == border * parts
    assert not mesh.closed
    assert np.isnan(mesh.volume)
    assert len(mesh.split.vertices) == len(mesh.vertices)
    ways = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(ways, axis=0)) == len(ways)  # neighbours pass an edge in opposite ways
    assert (mesh.normals[:, 2] > 0.0).all()
    assert from_patches(spline, mesh, parts).max() < 1e-14


@pytest.mark.parametrize("parts", PARTS)
def test_creases_share_points_and_not_normals(parts: int) -> None:
    spline = gm.Spline.from_nets(*octants())
    mesh = spline.mesh(parts)
    assert mesh.closed
    assert (mesh.euler_characteristic, len(mesh.triangles)) == (2, 8 * parts**2)
    inside = (parts + 1) * (parts + 2) // 2
    # Normals agree at the six corners, and nowhere else on the twelve joints.
    assert len(mesh.split.vertices) == 8 * inside - 6 * 3
    assert (np.einsum("kx,kx->k", mesh.normals, mesh.vertices) > 0.0).all()


@pytest.mark.parametrize("parts", PARTS)
def test_patches_at_the_tip_of_a_cone_have_their_own_normals(parts: int) -> None:
    """All are singular there. They are perpendicular to the cone, whose generators fall by 45°."""
    position, domain = ("v*cos(u)", "-v*sin(u)", "1 - v"), ((0, "2*pi"), (0, 1))
    cone = gm.Surface.from_sympy(position, ("u", "v"), domain, periodic=(True, False))
    spline = gm.Spline.from_nets(gm.fit(cone, (16, 4)).control_nets)
    mesh = spline.mesh(parts)
    assert (mesh.euler_characteristic, len(mesh.boundary_edges)) == (1, 16 * parts)
    at_tip = np.linalg.norm(mesh.vertices[mesh.triangles] - [0, 0, 1], axis=2) < 1e-9
    patches = np.nonzero(at_tip)[0]
    tip = mesh.corner_normals[at_tip]
    assert np.abs(tip[:, 2] - np.sqrt(0.5)).max() < 0.02
    for patch in np.unique(mesh.face_index[patches]):
        own = tip[mesh.face_index[patches] == patch]
        assert np.abs(own - own[0]).max() < 1e-6
        assert own[0, :2] @ spline.control_nets[patch, :, :2].mean(axis=0) > 0.0
    assert len(np.unique(tip.round(3), axis=0)) == (32 if parts == 1 else 48)


@pytest.mark.parametrize("parts", [0, -1, 1.5, "2"])
def test_parts_that_are_none(parts: int) -> None:
    refused("parts must be a whole number", gm.Spline.from_nets(*octants()).mesh, parts)


def test_more_parts_than_memory_holds() -> None:
    refused(r"vertices of a mesh need about .* parts", gm.Spline.from_nets(*octants()).mesh, 10**6)
