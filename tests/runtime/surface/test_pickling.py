"""Every surface pickles, and works in other processes."""

import pickle
import subprocess
import sys

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp

from ...products import covering
from ...shapes import tube

TURN = ((0.0, 2 * np.pi), (0.0, 2 * np.pi))


def plane(u, v):
    return np.stack([u, v, 0 * u], axis=-1)


def plane_derivatives(u, v):
    jets = np.zeros((*u.shape, 6, 3))
    jets[..., 0, :] = plane(u, v)
    jets[..., 1, 0] = jets[..., 2, 1] = 1.0
    return jets


def all_kinds():
    periodic = (True, True)
    made = {
        "catalogue": gm.surfaces.torus(minor=0.2),
        "sympy": gm.Surface.from_sympy(
            ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "Piecewise((v, v < 1), (Abs(v), True))"),
            sp.symbols("u v", positive=True),
            TURN,
        ),
        "callable": gm.Surface.from_callable(tube, TURN, periodic),
        "given": gm.Surface.from_callable(plane, TURN, derivatives=plane_derivatives),
        "nurbs": gm.Surface.from_nurbs(
            (1, 1), ([0, 0, 4, 7, 7], [0, 0, 7, 7]), plane(*np.indices((3, 2)) * 1.0)
        ),
        "trimmed": gm.surfaces.torus().trimmed([[(1, 1), (3, 1), (1, 3)]]),
        "grid": gm.Surface.from_grid(tube(*np.indices((5, 6)) / 2)),
    }
    return made | {f"flipped {name}": surface.flipped() for name, surface in made.items()}


@covering(name=all_kinds(), used=[False, True])
def test_pickling(name, used):
    surface = all_kinds()[name]
    u, v = np.random.default_rng(0).uniform(0.5, 3.0, (2, 20))
    if used and surface.grid is None:  # what is compiled is left out
        surface.derivatives(u, v)
    copy = pickle.loads(pickle.dumps(surface))
    assert (copy.name, copy.domain, copy.boundary) == (
        surface.name,
        surface.domain,
        surface.boundary,
    )
    assert np.array_equal(copy.evaluate(u, v), surface.evaluate(u, v))
    if surface.grid is None:
        assert np.array_equal(copy.derivatives(u, v), surface.derivatives(u, v))


def test_curves_pickle():
    curve = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True)
    assert np.array_equal(pickle.loads(pickle.dumps(curve)).evaluate(1.0), curve.evaluate(1.0))


SCRIPT = """
import multiprocessing
import joblib
import gaussmap as gm


def height(surface):
    jets = surface.derivatives(0.5, 0.75)
    return surface.name, jets.tolist(), gm.fit(surface, (8, 8)).evaluate(0.5, 0.5).tolist()


if __name__ == "__main__":
    surfaces = [
        gm.surfaces.torus(minor=0.2),
        gm.Surface.from_sympy(("u", "v", "Abs(u*v)"), "uv", ((0, 1), (0, 1))),
        gm.surfaces.moebius_band().flipped(),
    ]
    expected = [height(x) for x in surfaces]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(height, surfaces) == expected
    assert joblib.Parallel(n_jobs=2)(joblib.delayed(height)(x) for x in surfaces) == expected
    print("equal")
"""


@pytest.mark.slow
def test_surfaces_in_other_processes(tmp_path):
    """With spawn, as on macOS and Windows, and with joblib's loky."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    run = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, timeout=300, check=False
    )
    assert run.stdout.strip() == "equal", run.stderr
