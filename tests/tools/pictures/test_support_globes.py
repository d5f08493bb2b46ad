import gaussmap as gm
import numpy as np
from gaussmap.tools.pictures.scene import view
from gaussmap.tools.pictures.support_globes import branches_of, values_on_globe


def test_a_torus_has_two_branches() -> None:
    samples = gm.sample("torus", 400, cells=(16, 16))
    elliptic, hyperbolic = branches_of(samples)
    assert (elliptic.name, hyperbolic.name) == ("K > 0", "K < 0")
    assert (samples.kind[elliptic.samples | hyperbolic.samples] == "normal").all()
    assert (samples.gaussian_curvature[elliptic.samples] > 0).all()
    assert (samples.gaussian_curvature[hyperbolic.samples] < 0).all()


def test_more_branches_are_not_drawn() -> None:
    waves = gm.surfaces.surface("wavy_graph")
    assert branches_of(gm.sample(waves, normals=gm.fibonacci(200))) == []
    assert branches_of(gm.sample("torus", 50, density="uniform", cells=(16, 16))) == []
    fields = ("points", "normals", "gaussian_curvature", "normal_index")
    assert branches_of(gm.sample("torus", normals=gm.icosphere(2), fields=fields)) == []


def globe_of(samples: gm.Samples) -> tuple[np.ndarray, ...]:
    """Return the values on the globe of the samples with K > 0, and x, y of its pixels."""
    branch = branches_of(samples)[0].samples
    values = values_on_globe(samples.normals[branch], samples.points[branch], view())
    return values, *np.meshgrid(*2 * [np.linspace(-1.0, 1.0, len(values))])


def test_colours_are_the_support_function() -> None:
    """That of the torus with K > 0 is R·|(n_x, n_y)| + r; errors are squares of angles."""
    values, x, y = globe_of(gm.sample("torus", normals=gm.fibonacci(2000)))
    inside = np.hypot(x, y) < 1.0
    z = np.sqrt(np.where(inside, 1.0 - x * x - y * y, 0.0))
    across = np.linalg.norm((np.stack([x, y, z], axis=2) @ view())[..., :2], axis=2)
    exact = 1.0 * across + 0.35
    assert np.abs(values - exact)[inside & (across > 0.1)].max() < 0.02
    assert np.abs(values - exact)[inside].max() < 0.06  # at the pole h has no gradient


def test_far_from_all_normals_nothing_is_drawn() -> None:
    near = gm.directions.cap(gm.fibonacci(2000), view()[2], 30)
    values, x, y = globe_of(gm.sample("torus", normals=near))
    r = np.hypot(x, y)
    assert np.isfinite(values[r < 0.45]).all()
    assert np.isnan(values[(r > 0.65) & (r < 1.0)]).all()
