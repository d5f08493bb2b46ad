import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.marked import Marked, marked
from gaussmap.tools.pictures.scene import scene_of, view


def test_both_points_of_a_torus_are_visible() -> None:
    torus = gm.fit(gm.surfaces.torus(), cells=(24, 24))
    samples = gm.sample(torus, normals=gm.fibonacci(300))
    found = marked(samples, scene_of(torus).visible(samples.points), view())
    assert np.count_nonzero(found.visible) == np.count_nonzero(found.samples) == 2
    assert (samples.normals[found.samples] == found.normal).all()
    assert 0.3 < np.linalg.norm(view()[:2] @ found.normal) < 0.95  # an arrow that is seen
    assert found.label == "one normal and its points (2)"


def test_rare_samples_are_not_marked() -> None:
    samples = gm.sample("torus", normals=gm.fibonacci(40), cells=(16, 16))
    few = samples.normal_index == samples.normal_index[np.argmax(samples.normals @ view()[2])]
    visible = ~few
    visible[np.flatnonzero(few)[0]] = True  # one visible sample, where the others have two
    found = marked(samples, visible, view())
    assert not (found.samples & few).any()


def test_nothing_is_marked_without_prescribed_normals() -> None:
    samples = gm.sample("torus", 50, density="uniform", cells=(16, 16))
    assert marked(samples, np.ones(len(samples), dtype=bool), view()) is None


@pytest.mark.parametrize(
    ("count", "seen", "label"),
    [
        (1, 1, "one normal and its point"),
        (2, 1, "one normal and its points (2, 1 visible)"),
        (1200, 1200, "one normal and its points (1,200)"),
    ],
)
def test_the_label(count: int, seen: int, label: str) -> None:
    rows = np.arange(2000)
    assert Marked(np.array([0.0, 0.0, 1.0]), rows < count, rows < seen).label == label
