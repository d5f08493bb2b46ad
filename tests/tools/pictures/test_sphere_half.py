import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.scene import view
from gaussmap.tools.pictures.sphere_half import draw_sphere, view_of


@pytest.mark.parametrize("mean", [(0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 0, -1), None])
def test_the_view_of_the_sphere(mean: tuple[float, float, float] | None) -> None:
    vectors = np.array([-view()[2] if mean is None else mean], dtype=float)
    seen_from = view_of(vectors)
    np.testing.assert_allclose(seen_from @ seen_from.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(seen_from) == pytest.approx(1.0)
    np.testing.assert_allclose(seen_from[2], vectors[0] if vectors.any() else view()[2], atol=1e-12)


def test_the_legend_counts_normals_of_each_kind() -> None:
    from matplotlib.figure import Figure

    def labels(samples: gm.Samples, normals: np.ndarray) -> list[object]:
        axes = Figure().add_subplot()
        return [handle.get_label() for handle in draw_sphere(axes, samples, normals, view())]

    torus = gm.fit(gm.surfaces.torus(), cells=(24, 24))
    balanced = gm.sample(torus, 300)
    searched = len(np.unique(balanced.normal_index)) - 1
    filling = int(np.count_nonzero(balanced.kind == "filling"))
    none = np.empty((0, 3))
    assert labels(balanced, none) == [f"filling gaps ({filling})", f"prescribed ({searched})"]
    aligned = gm.sample(torus, 300, density="aligned")
    assert f"on a grid ({np.count_nonzero(aligned.kind == 'grid')})" in labels(aligned, none)
    bowl = gm.fit(gm.surfaces.elliptic_paraboloid(), cells=(16, 16))
    normals = gm.fibonacci(100)
    found = len(gm.sample(bowl, normals=normals))
    assert labels(gm.sample(bowl, normals=normals), normals) == [
        f"prescribed, no sample ({100 - found})",
        f"prescribed ({found})",
    ]
