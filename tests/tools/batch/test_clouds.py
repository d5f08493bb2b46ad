"""Batches for training: every part once, reproducible, divided among workers, in own memory."""

import gc
import pickle
import re
import tracemalloc
import warnings
from collections import Counter
from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from . import made

pytest.importorskip("pyarrow")
pytestmark = pytest.mark.filterwarnings("ignore:part [0-9]+ has")
# The first columns of points are the number of the part and the row.
PART, ROW = 0, 1


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> gm.Dataset:
    return made.write(tmp_path_factory.mktemp("data") / "set")


def points_by_part(batches) -> dict[int, np.ndarray]:
    found: dict[int, np.ndarray] = {}
    for points, normals, numbers in batches:
        for part, cloud, n in zip(numbers.tolist(), points, normals, strict=True):
            assert part not in found
            assert (cloud[:, PART] == part).all()
            known = made.samples_of(part, made.COUNTS[part])
            np.testing.assert_array_equal(n, known.normals[cloud[:, ROW].astype(int)])
            found[part] = cloud
    return found


def test_in_the_order_of_the_list(dataset):
    batches = list(dataset.batches(40, 4))
    assert [x[2].tolist() for x in batches] == [made.HELD[k : k + 4] for k in range(0, 12, 4)]
    for points, normals, numbers in batches:
        assert points.shape == normals.shape == (len(numbers), 40, 3)
        for cloud, n, part in zip(points, normals, numbers.tolist(), strict=True):
            known = made.samples_of(part, made.COUNTS[part])
            rows = np.arange(40) % made.COUNTS[part]
            np.testing.assert_array_equal(cloud, known.points[rows])
            np.testing.assert_array_equal(n, known.normals[rows])


def test_shuffled_every_part_comes_once(dataset):
    batches = list(dataset.batches(45, 4, shuffle=3))
    assert [len(x[2]) for x in batches] == [4, 4, 3]
    found = points_by_part(batches)
    assert sorted(found) == made.HELD
    assert list(found) != made.HELD
    for part, cloud in found.items():
        rows = Counter(cloud[:, ROW].astype(int).tolist())
        least, rest = divmod(45, made.COUNTS[part])
        # Without repetition, or each row as often as any other, but for one.
        assert {*rows.values()} <= {least, least + 1} - {0}
        assert len(rows) == min(45, made.COUNTS[part])
        assert sum(x == least + 1 for x in rows.values()) == rest if least else True


def test_the_same_seed_gives_the_same_batches(dataset):
    def run(seed: int | tuple[int, ...]) -> list[bytes]:
        return [a.tobytes() for x in dataset.batches(16, 3, shuffle=seed) for a in x]

    assert run(0) == run(0) == run((0,))
    assert len({tuple(run(x)) for x in (0, 1, (0, 0), (0, 1), (1, 0))}) == 5


@pytest.mark.parametrize("workers", [1, 2, 3, 5])
def test_workers_divide_the_parts_and_draw_the_same_points(dataset, workers):
    alone = points_by_part(dataset.batches(30, 4, shuffle=7))
    found: dict[int, np.ndarray] = {}
    for k in range(workers):
        part = points_by_part(dataset.batches(30, 4, shuffle=7, shard=(k, workers)))
        assert not part.keys() & found.keys()
        found |= part
    assert sorted(found) == made.HELD
    for part, cloud in found.items():
        np.testing.assert_array_equal(cloud, alone[part])


def test_all_orders_come(dataset):
    """Each of the 11 parts is the first one about equally often."""
    firsts = Counter(
        int(next(dataset.batches(1, 1, shuffle=seed, fields=("points",)))[1][0])
        for seed in range(110)
    )
    # Binomial with mean 10 and deviation 3; the seeds are fixed.
    assert sorted(firsts) == made.HELD
    assert max(firsts.values()) <= 22


def test_the_last_batch(dataset):
    assert [len(x[-1]) for x in dataset.batches(8, 4, drop_last=True)] == [4, 4]
    assert [len(x[-1]) for x in dataset.batches(8, 100, shuffle=0)] == [11]
    assert not list(dataset.batches(8, 100, drop_last=True))


def test_fields_and_what_parts_lack(dataset):
    fields = ("face_index", "on_surface", "component", "normals", "gaussian_curvature")
    for *arrays, numbers in dataset.batches(10, 4, fields=fields, dtype=np.float32):
        faces, on, component, normals, K = arrays
        assert [x.dtype for x in arrays] == [np.int64, np.bool_, np.uint8, *2 * [np.float32]]
        assert normals.shape == (len(numbers), 10, 3)
        assert K.shape == component.shape == faces.shape == (len(numbers), 10)
        for k, part in enumerate(numbers.tolist()):
            assert (faces[k] >= 0).all() if part % 3 == 2 else (faces[k] == -1).all()
            assert not on[k].any() or part % 3 != 1
            assert (component[k] == (0 if part % 3 == 2 else 1 + part % 4)).all()


def test_labels(dataset):
    by_part = {part: part % 4 for part in range(13)}
    for *_, numbers, labels in dataset.batches(8, 4, shuffle=0, labels=by_part):
        assert labels.dtype == np.int64
        np.testing.assert_array_equal(labels, numbers % 4)
    by_name = {f"part {part}": part / 2 for part in made.HELD}
    for *_, numbers, labels in dataset.batches(8, 4, labels=by_name):
        np.testing.assert_array_equal(labels, numbers / 2, strict=True)
    for *_, numbers, labels in dataset.batches(8, 4, labels="samples"):
        np.testing.assert_array_equal(labels, [made.COUNTS[x] for x in numbers], strict=True)
    assert next(dataset.batches(8, labels="misfit"))[-1].tolist() == [0.25] * 11
    refused("part 2 has no label", list, dataset.batches(8, labels={0: 1}))


def test_labels_in_an_array(dataset):
    for array in (np.arange(13) % 4, (np.arange(13) % 4).tolist()):
        for *_, numbers, labels in dataset.batches(8, 4, shuffle=0, labels=array):
            np.testing.assert_array_equal(labels, numbers % 4, strict=True)
    *_, numbers, labels = next(dataset.batches(3, 4, labels=np.arange(13, dtype="float32")))
    np.testing.assert_array_equal(labels, numbers.astype(np.float64), strict=True)


def test_labels_by_names_of_several_parts(tmp_path, monkeypatch):
    names = {3: "part 7", 9: "part 8", 12: "part 8"}
    before = made.row_of
    monkeypatch.setattr(
        made,
        "row_of",
        lambda part, count: replace(x := before(part, count), name=names.get(part, x.name)),
    )
    dataset = made.write(tmp_path)
    with pytest.raises(gm.errors.InputError, match="parts 3 and 7 have the same name 'part 7'"):
        dataset.batches(8, labels={f"part {part}": 1 for part in range(8)})
    # Nothing is ambiguous about others.
    *_, numbers, labels = next(dataset.batches(8, 2, labels={"part 0": 5, "part 2": 6}))
    assert (numbers.tolist(), labels.tolist()) == ([0, 2], [5, 6])
    (*_, labels), *_ = dataset.batches(8, 11, labels=range(13))
    assert labels.tolist() == made.HELD


def test_parts_with_fewer_samples_are_repeated_with_one_warning(dataset):
    for seed in (None, 0):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            batches = list(dataset.batches(52, 4, shuffle=seed))
        (warning,) = caught
        assert warning.filename == __file__
        assert warning.category is gm.errors.GaussmapWarning
        text = str(warning.message)
        part, count = (int(x) for x in re.findall(r"part (\d+) has (\d+) samples", text)[0])
        assert made.COUNTS[part] == count < 52
        assert {len(x[0][0]) for x in batches} == {52}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert list(dataset.batches(3, 4))


def test_arrays_are_taken_by_pytorch_without_a_copy(dataset):
    """What torch.from_numpy and from_dlpack ask for: writable, contiguous, native, own memory."""
    seen = []
    by_part = dict.fromkeys(range(13), 1.5)
    for batch in dataset.batches(32, 4, shuffle=0, dtype="float32", labels=by_part):
        for array in batch:
            assert array.flags.c_contiguous
            assert array.flags.writeable
            assert array.flags.aligned
            assert array.flags.owndata
            assert array.dtype.isnative
            shared = np.from_dlpack(array)
            assert np.shares_memory(shared, array)
            shared[...] = 0  # a user may write to it
        assert [x.dtype.name for x in batch] == ["float32", "float32", "int64", "float64"]
        assert not any(np.shares_memory(a, b) for a in batch for b in seen)
        seen += batch


def test_clouds_are_the_batches_one_by_one(dataset):
    how = {"shuffle": 3, "dtype": "float32", "labels": "samples"}
    clouds = dataset.clouds(45, **how)
    found = {part: (*arrays, label) for *arrays, part, label in clouds}
    assert (len(clouds), list(found)) == (len(made.HELD), made.HELD)
    for *arrays, numbers, labels in dataset.batches(45, 4, **how):
        for k, part in enumerate(numbers.tolist()):
            *cloud, label = found[part]
            assert label == labels[k]
            for one, several in zip(cloud, arrays, strict=True):
                np.testing.assert_array_equal(one, several[k], strict=True)
    assert {type(x) for x in clouds[0][2:]} == {int}
    assert isinstance(dataset.clouds(9, labels="misfit")[-1][-1], float)
    with pytest.raises(IndexError):
        clouds[len(clouds)]
    refused("part 2 has no label", dataset.clouds(9, labels={0: 1}).__getitem__, 1)


def test_clouds_are_pickled_as_for_the_processes_of_a_loader(dataset):
    clouds = dataset.clouds(9, shuffle=1, labels="samples")
    copy = pickle.loads(pickle.dumps(clouds))
    for a, b in zip(clouds[3], copy[3], strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("wrong", "error", "text"),
    [
        ({"points": 0}, gm.errors.InputError, "points"),
        ({"parts": 2.5}, gm.errors.InputError, "parts"),
        ({"shuffle": -1}, gm.errors.InputError, "shuffle"),
        ({"shuffle": "seed"}, gm.errors.InputError, "shuffle"),
        ({"shard": (2, 2)}, gm.errors.InputError, "from 0 to 1"),
        ({"shard": (0, 0)}, gm.errors.InputError, "shard"),
        ({"fields": "points"}, gm.errors.InputError, "tuple of names"),
        ({"fields": ("points", "points")}, gm.errors.InputError, "twice"),
        ({"fields": ("uv",)}, gm.errors.UnknownNameError, "no field 'uv'"),
        ({"dtype": "int32"}, gm.errors.InputError, "dtype"),
        ({"labels": "name"}, gm.errors.UnknownNameError, "column of numbers"),
        ({"labels": [1, 2]}, gm.errors.InputError, "one number for each of 13 parts"),
        ({"labels": 13 * ["chair"]}, gm.errors.InputError, "real numbers"),
        ({"labels": {0: 1, "part 2": 1}}, gm.errors.InputError, "not by both"),
        ({"labels": {0: "chair"}}, gm.errors.InputError, "must be a number, not 'chair'"),
        ({"drop_last": np.zeros(2)}, gm.errors.InputError, "drop_last"),
    ],
)
def test_wrong_arguments_are_refused_at_once(dataset, wrong, error, text):
    refused(text, dataset.batches, **wrong, error=error)
    if not wrong.keys() & {"parts", "shard", "drop_last"}:
        refused(text, dataset.clouds, **wrong, error=error)


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_parts(tmp_path):
    peaks = []
    for parts in (20, 80):
        dataset = made.write(tmp_path / str(parts), parts * (200,))
        next(dataset.batches(1))  # what is imported
        tracemalloc.start()
        for _ in dataset.batches(100, 4, shuffle=0):
            gc.collect()
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # 4 parts in a batch, as many again while it is put together, and the columns of one.
    assert max(peaks) < 2 * 5 * 200 * 6 * 8 + 120_000
