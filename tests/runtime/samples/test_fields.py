"""Only some fields, and float32: the same numbers, and a sentence for what is missing."""

import copy
import pickle
from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples import fields as names
from gaussmap.runtime.samples.fields import ARRAY_NAMES, FLOAT_NAMES
from gaussmap.runtime.samples.samples import Samples

from ...refusals import refused
from ...shapes import same

# The vertices of the icosphere lie in planes of symmetry: some samples are decided exactly.
NORMALS = gm.icosphere(6)
SPLINE = gm.fit(gm.surfaces.torus(), (12, 8))
FULL = gm.sample(SPLINE, normals=NORMALS)
SUBSETS = [(name,) for name in ARRAY_NAMES] + [
    ("points", "normals"),
    ("mean_curvature", "uv"),
    ("patch_index", "support", "gaussian_curvature"),
    ("normal_index", "patch_index"),
]


def narrow(fields: Any = ("points",), **options: Any) -> Samples:
    return gm.sample(SPLINE, normals=NORMALS, fields=fields, **options)


# --- what is stored -------------------------------------------------------------------------------


@pytest.mark.parametrize("fields", SUBSETS, ids="-".join)
def test_fields_are_those_of_a_full_sampling(fields):
    samples = narrow(fields)
    assert len(samples) == len(FULL)
    known = FULL.report.infinite_curvatures if "gaussian_curvature" in fields else None
    assert samples.report == replace(FULL.report, infinite_curvatures=known)
    assert samples.fields == tuple(name for name in ARRAY_NAMES if name in fields)
    for name in ARRAY_NAMES:
        assert hasattr(samples, name) == (name in fields)
    for name in fields:
        assert getattr(samples, name).tobytes() == getattr(FULL, name).tobytes()


@pytest.mark.parametrize("dtype", [np.float32, "float32", np.dtype(np.float32), "f4"])
def test_float32_is_float64_rounded_once(dtype):
    samples = narrow(None, dtype=dtype)
    assert samples.dtype == np.float32
    for name in FLOAT_NAMES:
        array = getattr(samples, name)
        assert array.dtype == np.float32
        assert array.tobytes() == getattr(FULL, name).astype(np.float32).tobytes()
    for name in names.INDEX_NAMES:
        assert getattr(samples, name).dtype == np.int64
        assert (getattr(samples, name) == getattr(FULL, name)).all()
    assert (samples.elliptic == FULL.elliptic).all()


@pytest.mark.parametrize("on", ["surface", "spline"])
def test_components_are_those_of_prescribed_normals(tmp_path, on):
    torus, codes = gm.surfaces.torus(), [gm.Component.REGULAR] * 2
    at_normal = gm.GaussMap(torus, cells=(12, 8), on=on).points([[1, 0, 0]])
    assert (at_normal.component.dtype, at_normal.component.tolist()) == (np.uint8, codes)
    assert gm.sample(torus, 50, cells=(12, 8), on=on).component is None
    for name in ("a.npz", "a.ply"):
        at_normal.write(tmp_path / name)
        assert np.array_equal(gm.read_samples(tmp_path / name).arrays()["component"], codes)
    fields = ("component", "points")
    (chunk,) = gm.sample_stream(torus, normals=[[1, 0, 0]], cells=(12, 8), on=on, fields=fields)
    chunk.write(tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text().splitlines()[1].endswith(",0")
    refused("at prescribed normals only", gm.sample, torus, 50, fields=fields)
    refused("at prescribed normals only", gm.sample_stream, torus, 50, fields=fields)


# --- what is missing ------------------------------------------------------------------------------


def test_a_missing_field_is_said_to_be():
    samples = narrow(("points", "normals"))
    with pytest.raises(
        gm.errors.MissingFieldError, match=r"hold points, normals only; add 'uv' to the fields"
    ):
        _ = samples.uv
    for name in ("elliptic", "hyperbolic", "principal_curvatures"):
        assert not hasattr(samples, name)
        with pytest.raises(gm.errors.MissingFieldError, match=f"^{name} needs gaussian_curvature"):
            getattr(samples, name)
    lacks_mean = narrow(("gaussian_curvature",))
    assert lacks_mean.elliptic.any()
    with pytest.raises(gm.errors.MissingFieldError, match="needs mean_curvature, but"):
        _ = lacks_mean.principal_curvatures
    with pytest.raises(AttributeError, match="has no attribute 'curvature'") as caught:
        _ = samples.curvature  # pyright: ignore[reportAttributeAccessIssue]
    assert not isinstance(caught.value, gm.GaussmapError)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ("points", r"must be a tuple of names, such as \('points',\), not a string"),
        ("points,uv", "not a string"),
        ((), "fields is empty"),
        ([], "fields is empty"),
        (3, "must be a tuple of names, not 3"),
        (("points", "points"), "names 'points' twice"),
        (("points", "normal"), "no field 'normal'; did you mean normals"),
        (("colour",), "no field 'colour'; there is points, normals, uv"),
        ((1,), "no field 1"),
        ((None,), "no field None"),
        (("elliptic",), "elliptic is computed when it is read, from 'gaussian_curvature'"),
        (("principal_curvatures",), "from 'gaussian_curvature' and 'mean_curvature'"),
    ],
)
def test_fields_that_are_none(fields, message):
    error = gm.errors.UnknownNameError if "no field" in message else gm.errors.InputError
    check_refused(message, error, fields=fields)


@pytest.mark.parametrize(
    "dtype", ["float16", np.float128, int, ">f4", "numbers", object, 7, "f4,f4", None, "f("]
)
def test_types_that_are_none(dtype):
    check_refused("dtype must be float32 or float64, not", gm.errors.InputError, dtype=dtype)


def check_refused(message: str, error: type[Exception], **named: Any) -> None:
    """Check that all that samples refuses arguments."""
    for call in (
        lambda **x: gm.sample(SPLINE, normals=NORMALS, **x),
        lambda **x: next(gm.sample_many([SPLINE], normals=NORMALS, **x)),
        lambda **x: gm.sample_stream(SPLINE, normals=NORMALS, **x),
    ):
        refused(message, call, error=error, **named)


# --- samples of few fields ------------------------------------------------------------------------


def test_proved_samples_can_be_replaced():
    """They have no patches of a spline."""
    samples = gm.sample("torus", normals=gm.fibonacci(20))
    assert samples.report.proved == 20
    moved = replace(samples, points=samples.points + 1.0)
    assert samples.patch_index is moved.patch_index is None
    assert moved.fields == samples.fields


@pytest.mark.parametrize("fields", [ARRAY_NAMES, ("points", "uv", "normal_index"), ("points",)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_files_copies_pickles_and_parts(fields, dtype, tmp_path):
    samples, whole = narrow(fields, dtype=dtype), slice(None)
    paths = [tmp_path / "a.npz", tmp_path / "a.ply"]
    for path in paths:
        samples.write(path)
    for other in (copy.copy(samples), copy.deepcopy(samples), pickle.loads(pickle.dumps(samples)),
                  samples[whole], Samples.concatenate([samples[:5], samples[5:]]),
                  *map(gm.read_samples, paths)):  # fmt: skip
        assert other.report == samples.report
        same(other, samples)


def test_concatenation():
    parts = [FULL[:10], FULL[10:10], FULL[10:]]
    joined = Samples.concatenate(iter(parts))
    assert joined.report == FULL.report
    same(joined, FULL)
    other = replace(FULL, report=replace(FULL.report, surface="other", normals=3))
    report = Samples.concatenate([FULL, other]).report
    assert (report.surface, report.normals) == ("several surfaces", None)
    assert (report.samples, report.patches) == (2 * len(FULL), FULL.report.patches)
    proofs = [replace(FULL, report=replace(FULL.report, proved=k, undecided=())) for k in (2, 3)]
    assert Samples.concatenate(proofs).report.proved == 5
    for unusable in ([], [FULL, narrow()], [FULL, narrow(None, dtype="f4")], [1], [FULL, None]):
        refused("", Samples.concatenate, unusable)  # pyright: ignore[reportArgumentType]


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("suffix", "fields", "lacking"),
    [(".ply", ("uv",), "'points'"), (".vtp", ("normals",), "'points'"),
     (".xyz", ("uv",), "'points' and 'normals'"), (".xyz", ("points",), "'normals'")],
)  # fmt: skip
def test_formats_say_what_they_need(tmp_path, suffix, fields, lacking):
    refused(f"a {suffix} file needs {lacking}; add", narrow(fields).write, tmp_path / f"a{suffix}")
    assert not any(tmp_path.iterdir())


def test_a_file_that_lacks_what_it_promises(tmp_path):
    narrow(("points", "uv")).write(tmp_path / "a.ply")
    whole = (tmp_path / "a.ply").read_bytes()
    for old, new, message in (
        (b"fields points uv", b"fields points support", "lacks the columns support"),
        (b"fields points uv", b"fields points colour", "fields that gaussmap does not know"),
        (b"comment gaussmap fields points uv\n", b"", "lacks the columns nx"),
    ):
        (tmp_path / "b.ply").write_bytes(whole.replace(old, new))
        refused(message, gm.read_samples, tmp_path / "b.ply", error=gm.errors.FileError)


# --- memory that is used again --------------------------------------------------------------------


def test_out_is_written_again():
    opposite = gm.sample(SPLINE, normals=-NORMALS)
    again = gm.GaussMap(SPLINE).points(NORMALS, out=opposite)
    for name in ARRAY_NAMES:
        assert np.shares_memory(getattr(again, name), getattr(opposite, name))
        assert getattr(again, name).tobytes() == getattr(FULL, name).tobytes()


def test_out_that_does_not_fit_is_left_alone():
    few = gm.sample(SPLINE, normals=NORMALS[:20])
    single = gm.sample(SPLINE, normals=NORMALS, dtype=np.float32)
    fixed = gm.sample(SPLINE, normals=NORMALS)
    fixed.points.flags.writeable = False
    for held in (few, single, fixed):
        before = held.points.tobytes()
        again = gm.GaussMap(SPLINE).points(NORMALS, out=held)
        assert held.points.tobytes() == before
        assert again.points.tobytes() == FULL.points.tobytes()


@pytest.mark.parametrize("of", ["torus", "part", "spline"])
def test_out_is_refused_where_it_would_not_be_used(of, parts):
    """Samples of a surface or a part are not of one spline; what is no samples is never."""
    known = gm.GaussMap({"torus": "torus", "part": parts.box(), "spline": SPLINE}[of])
    out, said = known.points([[0, 0, 1]]), "out=.* holds samples of one spline"
    if of == "spline":
        out, said = 3, "out must be Samples of an earlier call, not 3"
    refused(said, known.points, NORMALS[:1], out=out)
