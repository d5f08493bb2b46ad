"""Clouds for training: every part once, reproducible, in own memory."""

import gc
import pickle
import re
import tracemalloc
import warnings
from collections import Counter

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from . import made

pytestmark = pytest.mark.filterwarnings("ignore:part [0-9]+ has")
# The first columns of points are the number of the part and the row.
PART, ROW = 0, 1


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> gm.Dataset:
    return made.write(tmp_path_factory.mktemp("data") / "set")


def test_the_first_points_in_the_order_of_the_list(dataset):
    clouds = dataset.clouds(45)
    assert len(clouds) == len(made.HELD)
    assert [part for *_, part in clouds] == made.HELD
    for points, normals, part in clouds:
        known = made.samples_of(part, made.COUNTS[part])
        rows = np.arange(45) % made.COUNTS[part]
        np.testing.assert_array_equal(points, known.points[rows], strict=True)
        np.testing.assert_array_equal(normals, known.normals[rows], strict=True)
    with pytest.raises(IndexError):
        clouds[len(clouds)]


def test_points_are_drawn_at_random(dataset):
    for points, normals, part in dataset.clouds(45, shuffle=3):
        assert (points[:, PART] == part).all()
        rows = points[:, ROW].astype(int)
        known = made.samples_of(part, made.COUNTS[part])
        np.testing.assert_array_equal(normals, known.normals[rows])
        assert rows.tolist() != (np.arange(45) % made.COUNTS[part]).tolist()
        drawn = Counter(rows.tolist())
        least, rest = divmod(45, made.COUNTS[part])
        # Without repetition, or each row as often as any other, but for one.
        assert {*drawn.values()} <= {least, least + 1} - {0}
        assert len(drawn) == min(45, made.COUNTS[part])
        assert sum(x == least + 1 for x in drawn.values()) == rest if least else True


def test_the_same_seed_gives_the_same_points(dataset):
    def run(seed: int | tuple[int, ...]) -> list[bytes]:
        return [x[0].tobytes() for x in dataset.clouds(16, shuffle=seed)]

    assert run(0) == run(0) == run((0,))
    assert len({tuple(run(x)) for x in (0, 1, (0, 0), (0, 1), (1, 0))}) == 5


def test_fields_and_what_parts_lack(dataset):
    fields = ("face_index", "on_surface", "component", "normals", "gaussian_curvature")
    for *arrays, part in dataset.clouds(10, fields=fields, dtype=np.float32):
        faces, on, component, normals, K = arrays
        assert [x.dtype for x in arrays] == [np.int64, np.bool_, np.uint8, *2 * [np.float32]]
        assert normals.shape == (10, 3)
        assert K.shape == component.shape == faces.shape == (10,)
        assert (faces >= 0).all() if part % 3 == 2 else (faces == -1).all()
        assert not on.any() or part % 3 != 1
        assert (component == (0 if part % 3 == 2 else 1 + part % 4)).all()


@pytest.mark.parametrize("labels", [np.arange(13) % 4, [x % 4 for x in range(13)], range(13)])
def test_labels(dataset, labels):
    for *_, part, label in dataset.clouds(8, labels=labels):
        assert label == labels[part]
        assert type(label) is int
    assert dataset.clouds(8, labels=np.arange(13) / 2)[1][-1] == made.HELD[1] / 2


def test_parts_with_fewer_samples_are_repeated_with_one_warning(dataset):
    for seed in (None, 0):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            clouds = list(dataset.clouds(52, shuffle=seed))
        (warning,) = caught
        assert warning.filename == __file__
        assert warning.category is gm.errors.GaussmapWarning
        text = str(warning.message)
        part, count = (int(x) for x in re.findall(r"part (\d+) has (\d+) samples", text)[0])
        assert made.COUNTS[part] == count < 52
        assert {len(x[0]) for x in clouds} == {52}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert list(dataset.clouds(3))


def test_arrays_are_taken_by_pytorch_without_a_copy(dataset):
    """What torch.from_numpy and from_dlpack ask for: writable, contiguous, native, own memory."""
    seen = []
    for *arrays, part in dataset.clouds(32, shuffle=0, dtype="float32"):
        assert type(part) is int
        for array in arrays:
            assert array.flags.c_contiguous
            assert array.flags.writeable
            assert array.flags.aligned
            assert array.flags.owndata
            assert array.dtype == np.dtype("=f4")
            shared = np.from_dlpack(array)
            assert np.shares_memory(shared, array)
            shared[...] = 0  # a user may write to it
        assert not any(np.shares_memory(a, b) for a in arrays for b in seen)
        seen += arrays


def test_clouds_are_pickled_as_for_the_processes_of_a_loader(dataset):
    clouds = dataset.clouds(9, shuffle=1, labels=range(13))
    copy = pickle.loads(pickle.dumps(clouds))
    for a, b in zip(clouds[3], copy[3], strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("wrong", "error", "text"),
    [
        ({"points": 0}, gm.errors.InputError, "points"),
        ({"shuffle": -1}, gm.errors.InputError, "shuffle"),
        ({"shuffle": "seed"}, gm.errors.InputError, "shuffle"),
        ({"fields": "points"}, gm.errors.InputError, "tuple of names"),
        ({"fields": ("points", "points")}, gm.errors.InputError, "twice"),
        ({"fields": ("uv",)}, gm.errors.UnknownNameError, "no field 'uv'"),
        ({"dtype": "int32"}, gm.errors.InputError, "dtype"),
        ({"labels": [1, 2]}, gm.errors.InputError, "one number for each of 13 parts"),
        ({"labels": 13 * ["chair"]}, gm.errors.InputError, "real numbers"),
    ],
)
def test_wrong_arguments_are_refused_at_once(dataset, wrong, error, text):
    refused(text, dataset.clouds, **wrong, error=error)


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_parts(tmp_path):
    peaks = []
    for parts in (20, 80):
        dataset = made.write(tmp_path / str(parts), parts * (200,))
        dataset.clouds(1)[0]  # what is imported
        tracemalloc.start()
        for _ in dataset.clouds(100, shuffle=0):
            gc.collect()
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # A cloud, another one while it is put together, and the columns of one.
    assert max(peaks) < 3 * 200 * 6 * 8 + 120_000
