"""What texts name: the same surfaces as in Python, and options that are not for them."""

import gaussmap as gm
import numpy as np
from gaussmap.tools.sources.named import Named
from gaussmap.tools.sources.surface_of import with_tolerance

HEIGHTS = np.add.outer(np.arange(6.0) ** 2, np.arange(5.0))
POINTS = np.stack([*np.meshgrid(np.arange(5.0), np.arange(6.0)), HEIGHTS], axis=-1)


def test_options_that_were_given() -> None:
    assert Named(surface="a.npy", spacing=(1.0, 2.0)).given() == {
        "surface": "a.npy",
        "spacing": (1.0, 2.0),
    }


def test_cells() -> None:
    torus = gm.surfaces.torus()
    assert with_tolerance(torus, Named(cells=(8, 9))) == (torus, (8, 9))
    found, cells = with_tolerance(torus, Named(tolerance=0.1))
    assert found is torus
    assert cells is not None
    misfit = gm.fit(torus, cells).misfit
    assert misfit.distance <= 0.1
    spline, cells = with_tolerance(gm.Surface.from_grid(POINTS), Named(tolerance=0.1))
    assert isinstance(spline, gm.Spline)
    assert cells is None
