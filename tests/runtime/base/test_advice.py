"""Mistakes of the first minute: one sentence that says what to do."""

import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gaussmap as gm
import geomdl.NURBS
import numpy as np
import pytest
from splipy import surface_factory

from ...refusals import refused

SQUARE = ((0, 1), (0, 1))


def of(f: Callable[..., Any]) -> gm.Surface:
    return gm.Surface.from_callable(f, SQUARE, name="mine")


MESH = SimpleNamespace(vertices=np.zeros((3, 3)), faces=np.zeros((1, 3), int))


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        ("tours", r"did you mean torus\?"),
        (
            "part.step",
            r"read the CAD file first: gm\.sample\(gm\.read_cad\('part\.step'\), \.\.\.\)",
        ),
        ("a.npy", r"gm\.Surface\.from_grid\(numpy\.load\('a\.npy'\)\)"),
        ("a.STL", "meshes are not taken, because triangles have no curvature; give the CAD file"),
        ("dem.tif", r"read the elevations first: gm\.sample\(gm\.terrain\('dem\.tif'\), \.\.\.\)"),
        (Path("a.step"), r"gm\.sample\(gm\.read_cad\('a\.step'\), \.\.\.\)"),
        (surface_factory.sphere(), r"make one by gm\.Surface\.from_nurbs\(surface\)\."),
        (geomdl.NURBS.Surface(), r"make one by gm\.Surface\.from_nurbs\(surface\)\."),
        (["torus", "sphere"], r"not list; gm\.Part\(surfaces\) .* gm\.sample_many\(surfaces, "),
        ((gm.surfaces.torus(),), r"not tuple; gm\.Part\(surfaces\) makes one of several"),
        ([[1.0, 2.0, 3.0]], r"not list; make one by gm\.Surface\.from_callable"),
        (MESH, "not SimpleNamespace; meshes are not taken"),
        (np.zeros((9, 3)), r"points \(N, 3\) in no order are not taken, .* grid \(m, n, 3\)"),
        (np.zeros((9, 9, 3)), r"not ndarray; make one by gm\.Surface\.from_grid\(points\)\."),
        (np.zeros((9, 9)), r"from_grid\(elevations, spacing=\(dx, dy\)\)"),
        (math.sin, r"gm\.Surface\.from_callable\(f, \(\(u0, u1\), \(v0, v1\)\)\)"),
        (SimpleNamespace(surface=None), r"give its surface: value\.surface"),
        (SimpleNamespace(faces=()), r"a face of a part has one: part\.faces\[0\]\.surface"),
        (None, "not NoneType; make one by gm.Surface.from_callable, from_sympy"),
        (of(lambda u, v: (u, v)), r"3 coordinates, not 2, joined by numpy\.stack"),
        (of(lambda u, v: [u, v, u, v]), r"3 coordinates, not 4, joined by numpy\.stack"),
        (of(lambda u, v: (u, v, u * v)), r"16, 3\): join the coordinates by numpy\.stack"),
        (of(lambda u, v: u * v), r"16, 3\): of heights z, numpy\.stack\(\(u, v, z\), axis=-1\)"),
        (of(lambda u, v: np.stack([u, v, np.log(u - v)], axis=-1)), "not finite.*trimmed to"),
        (of(lambda u, v: (u, v, math.sin(u))), "there are numpy.sin and so on, not math.sin"),
    ],
)
def test_what_is_no_surface(surface: Any, message: str) -> None:
    refused(message, gm.sample, surface, 10, error=gm.GaussmapError)


def test_a_cloud_is_no_grid() -> None:
    for spacing in None, (1.0, 1.0):
        with pytest.raises(gm.errors.InputError, match="in no order are not taken"):
            gm.Surface.from_grid(np.random.default_rng(0).random((50, 3)), spacing)


@pytest.mark.parametrize("count", [1000.0, np.float32(1000), 999.9])
def test_counts_that_are_no_integers(count: Any) -> None:
    refused(r"at least 1, not .*; 1000 for example", gm.sample, "torus", count)


@pytest.mark.parametrize("count", [-3.0, 0.5, 1e300, math.nan, math.inf, "1000", True])
def test_other_counts(count: Any) -> None:
    refused(r"of at least 1, not [^;]*\.$", gm.sample, "torus", count)


def test_samples_are_no_mesh(tmp_path: Any) -> None:
    samples = gm.sample("torus", 30, cells=(8, 8))
    with pytest.raises(gm.errors.UnknownNameError, match=r"of meshes; .* method `mesh`"):
        samples.write(tmp_path / "a.stl")
