import copy
import pickle
import warnings
from dataclasses import FrozenInstanceError, fields, replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples import fields as names
from gaussmap.runtime.samples.fields import ARRAY_NAMES, ARRAY_NAMES_ON_SURFACE, FLOAT_NAMES
from gaussmap.runtime.samples.report import SamplingReport, warn_of
from gaussmap.runtime.samples.samples import Samples
from hypothesis import given
from hypothesis import strategies as st

from ...refusals import refused
from ...shapes import moved, same, torus_samples

REPORT = SamplingReport("torus", 8, 12, 4, 0.125, 1)
FLAT = "of the surface is flat or developable (K = 0), which no set of normals can sample"
OF_ALL = "of 1,234,567 prescribed normals"
AT = f"10,012 samples at 10,012 {OF_ALL}, exactly 1 each"
TEN = f"10 of 10,012 samples at 10 {OF_ALL}, exactly 1 each (10 with K < 0)"
START = f"{AT} (5,012 with K > 0, 5,000 with K < 0)"
MISFIT: dict[str, Any] = {"developable_share": 0.0, "fit_distance": 1.0696e-5, "fit_rms": 6.0347e-6}


def torus(count: Any = 12, **changes: Any) -> Samples:
    return torus_samples(count, **changes)


def curved(K: object, H: object) -> Samples:
    K = np.array(K, dtype=float, ndmin=1)
    return torus(len(K), gaussian_curvature=K, mean_curvature=np.array(H, dtype=float, ndmin=1))


class TestConstruction:
    def test_the_spline_is_kept_by_picking_copying_and_concatenating(self):
        spline = gm.fit(gm.surfaces.torus(), cells=(8, 8))
        samples = gm.sample(spline, count=100)
        halves = [samples[:50], samples[50:]]
        assert all(part.spline is spline for part in (*halves, Samples.concatenate(halves)))
        copied = pickle.loads(pickle.dumps(samples)).spline
        np.testing.assert_array_equal(copied.coefficients, spline.coefficients)
        other = gm.sample(gm.surfaces.torus(), count=100, cells=(8, 8), on="spline")
        assert Samples.concatenate([samples, other]).spline is None
        assert torus().spline is None

    def test_the_surface_is_kept_and_pickled_if_it_pickles(self):
        surface = gm.Surface.from_callable(np.cross, ((0, 1), (0, 1)))
        samples = torus(surface=surface)
        halves = [samples[:5], samples[5:]]
        assert all(part.surface is surface for part in (*halves, Samples.concatenate(halves)))
        assert Samples.concatenate([samples, torus()]).surface is None
        assert pickle.loads(pickle.dumps(samples)).surface.domain == surface.domain
        unpicklable = gm.Surface.from_callable(lambda u, v: u, ((0, 1), (0, 1)))
        other = pickle.loads(pickle.dumps(torus(surface=unpicklable)))
        assert other.surface is None
        np.testing.assert_array_equal(other.points, samples.points)
        refused("surface must be a Surface or None, not str", torus, surface="torus")

    def test_whether_samples_are_on_the_surface_is_optional(self):
        there = np.arange(12) % 5 > 0
        samples = torus(on_surface=there)
        assert samples.fields == ARRAY_NAMES_ON_SURFACE
        assert torus().fields == ARRAY_NAMES
        assert torus().on_surface is None
        assert replace(torus(), report=REPORT).on_surface is None
        np.testing.assert_array_equal(samples[3:].on_surface, there[3:])
        joined = Samples.concatenate([samples[:6], samples[6:]])
        np.testing.assert_array_equal(joined.on_surface, there)
        assert joined.report.unrefined == 3
        assert Samples.concatenate([torus()]).report.unrefined is None
        refused("on_surface must be a bool array", torus, on_surface=np.ones(12))

    @pytest.mark.parametrize("name", ARRAY_NAMES)
    def test_arrays(self, name):
        """Shapes and types that are wrong are named; arrays become contiguous."""
        good = getattr(torus(), name)
        for bad in (good[:-1], good[..., None], good.ravel()[0]):
            wrong: Any = np.array(bad)
            said = refused("shape", torus, **{name: wrong})
            # When the points are wrong, all the others seem to be.
            assert name == "points" or said.startswith(f"{name} must be")
        swapped = good.astype(good.dtype.newbyteorder())
        for bad in (good.astype(np.float32), good.astype(object), swapped):
            refused(f"^{name} must be a {good.dtype} array", torus, **{name: bad})
        refused(f"^{name} must be a NumPy array, not list", torus, **{name: good.tolist()})
        strided = np.repeat(good, 2, axis=0)[::2]
        assert not strided.flags.c_contiguous
        result = getattr(torus(**{name: strided}), name)
        assert result.flags.c_contiguous
        np.testing.assert_array_equal(result, good)

    def test_they_are_frozen_not_copied_and_equal_to_themselves_only(self):
        samples = torus()
        assert torus(support=samples.support).support is samples.support
        assert samples == samples
        assert samples != torus()
        with pytest.raises(FrozenInstanceError):
            samples.support = np.zeros(12)  # pyright: ignore[reportAttributeAccessIssue]


class TestReport:
    def test_numpy_numbers_become_plain(self):
        numbers: Any = np.int64(3), np.int32(2), np.uint8(1), np.float32(0.5), 0
        more: Any = {
            "coverage": np.float32(2), "angle": np.int64(3), "infinite_curvatures": np.int8(4),
            "on": "surface", "unrefined": np.uint8(2), "proved": np.int16(0),
            "undecided": [(np.int64(0), np.arange(4), np.str_("open"), np.bool_(True), None, None)],
            "fit_distance": np.float32(1), "fit_rms": np.int8(1), "fit_angle": np.float64(1),
            "apexes": np.int16(1), "index": np.int64(7), "density": "aligned", "faces": np.int32(3),
            "empty_faces": np.uint8(1), "estimated_faces": np.int64(1), "oriented": True,
            "edge_samples": np.int64(2), "reach": (0, np.int8(0), 1, np.float32(60.0)),
            "edge_error": np.float32(1),
            "unit": np.str_("mm"), "crs": "EPSG:32633", "origin": np.array([1, 2.0, 0]),
        }  # fmt: skip
        report = SamplingReport("s", *numbers, **more)
        assert [type(getattr(report, f.name)) for f in fields(report)] == [
            str, int, int, int, float, int, float, float, int, str, int, int, tuple,
            float, float, float, int, int, str, int, int, int, bool, int, tuple, float, str, str,
            tuple,
        ]  # fmt: skip
        assert report.undecided == ((0, (0.0, 1.0, 2.0, 3.0), "open", True, None, None),)
        assert report.reach == (0.0, 0.0, 1.0, 60.0)
        assert report.undecided
        place = report.undecided[0]
        assert [type(x) for x in place[:4]] == [int, tuple, str, bool]

    def test_rounding_of_the_share_is_forgiven(self):
        assert replace(REPORT, developable_share=1.0 + 1e-15).developable_share == 1.0


class TestCurvatures:
    def test_the_sign_bit_counts(self):
        samples = curved([1.0, 0.0, -0.0, -1.0], 0.0 * np.ones(4))
        assert samples.elliptic.tolist() == [True, True, False, False]
        assert samples.hyperbolic.tolist() == [False, False, True, True]

    @pytest.mark.parametrize(
        ("K", "H", "expected"),
        [
            (4.0, 2.0, (2.0, 2.0)),  # sphere
            (4.0, -2.0, (-2.0, -2.0)),  # sphere, inward normals
            (1.0 + 1e-15, 1.0, (1.0, 1.0)),  # sphere, rounded: the discriminant is negative
            (-1.0, 0.0, (1.0, -1.0)),  # minimal surface
            (-1.0, -0.0, (1.0, -1.0)),
            (0.0, 0.0, (0.0, 0.0)),  # plane
            (-0.0, 0.5, (1.0, 0.0)),  # cylinder
            (-0.0, -0.5, (0.0, -1.0)),
            (2.0, -1.5, (-1.0, -2.0)),
            (1e-20, 0.5, (1.0, 1e-20)),  # H alone does not know the second one
            *((x, 1.0, (np.nan, np.nan)) for x in (np.inf, -np.inf, np.nan)),
            *((1.0, x, (np.nan, np.nan)) for x in (np.inf, np.nan)),
        ],
    )
    def test_simple_surfaces(self, K, H, expected):
        np.testing.assert_array_equal(curved(K, H).principal_curvatures, [expected])

    @given(
        st.floats(-1e3, 1e3).filter(lambda k: k == 0 or abs(k) > 1e-3),
        st.floats(-1e3, 1e3).filter(lambda k: k == 0 or abs(k) > 1e-3),
    )
    def test_product_and_mean_come_back(self, first, second):
        K, H = first * second, (first + second) / 2.0
        big, small = curved(K, H).principal_curvatures[0]
        size = max(abs(first), abs(second))
        assert big >= small
        # The root of a difference of squares: half the digits near umbilics.
        assert [big, small] == pytest.approx(
            sorted([first, second], reverse=True), rel=0, abs=4e-8 * size
        )
        assert (big + small) / 2.0 == pytest.approx(H, rel=0, abs=4e-16 * size)


class TestIndexing:
    @pytest.mark.parametrize(
        "key",
        [slice(None), slice(2, 7), slice(None, None, -3), slice(5, 5), np.arange(12) % 3 == 0,
         np.zeros(12, bool), np.array([7, 0, 7, -1]), np.array([3, 1], np.uint8), [4, 2],
         []], ids=str,
    )  # fmt: skip
    def test_all_arrays_are_cut_alike(self, key):
        samples = torus(12)
        part = samples[key]
        rows = np.arange(12)[key if not isinstance(key, list) else np.array(key, int)]
        assert len(part) == len(rows)
        assert part.report is samples.report
        for name in ARRAY_NAMES:
            array = getattr(part, name)
            assert array.flags.c_contiguous
            np.testing.assert_array_equal(array, getattr(samples, name)[rows])

    @pytest.mark.parametrize(
        ("key", "message"),
        [
            (12, "out of range: there are 12 samples"),
            (True, "picked by"),
            (1.0, "picked by"),
            ([0.5], "picked by"),
            ("support", "picked by"),
            ([[0, 1]], "picked by"),
            (None, "picked by"),
            (np.ones(11, bool), "the mask has 11 entries, but there are 12 samples"),
            (np.ones(0, bool), "the mask has 0 entries"),
            ([12], "out of range: there are 12 samples"),
            ([-13], "out of range"),
            (range(10**9), "too many for a sequence"),
        ],
        ids=str,
    )
    def test_bad_keys(self, key, message):
        with pytest.raises(gm.errors.InputError, match=message):
            torus(12)[key]


class TestText:
    def samples(self) -> Samples:
        K = np.ones(10012)
        K[:5000] = -1.0
        report = SamplingReport("torus", 1234567, 10012, 4, 0.03125, 0)
        return torus(10012, gaussian_curvature=K, report=report)

    def test_repr(self):
        assert repr(self.samples()) == (
            "Samples(10,012 points on torus: 5,012 with K > 0, 5,000 with K < 0)"
        )

    def test_repr_of_parabolic_samples(self):
        """The sign bit makes them elliptic or hyperbolic, and no text says so."""
        samples = curved([0.0, -0.0, 1e-12, -1e-12, 1e-3, -1e-3], np.ones(6))
        assert samples.hyperbolic.tolist() == [False, True, False, True, False, True]
        assert samples.parabolic.tolist() == [True, True, True, True, False, False]
        assert repr(samples).endswith(": 1 with K > 0, 1 with K < 0, 4 with K = 0)")

    def test_repr_stays_one_short_line(self):
        samples = torus(report=replace(REPORT, surface="x**2 +\n y**2 " * 20))
        assert len(repr(samples)) < 100
        assert repr(samples).startswith("Samples(12 points on x**2 + y**2 x**2")
        assert "…:" in repr(samples)
        assert "\n" not in repr(samples)

    @pytest.mark.parametrize(
        ("changes", "rows", "summary"),
        [
            ({}, slice(None), f"{START}; 3.12 % {FLAT}"),
            ({}, slice(10), f"{TEN}; 3.12 % {FLAT}"),
            ({"developable_share": 0.0}, slice(None), START),
            ({"developable_share": 4.9e-5}, slice(None), START),
            ({"developable_share": 5.1e-5}, slice(None), f"{START}; 0.01 % {FLAT}"),
            ({"developable_share": 1.0}, slice(None), f"{START}; 100.00 % {FLAT}"),
            (
                {"developable_share": 0.0, "unrefined": 1234}, slice(None),
                f"{START}; 1,234 samples could not be moved to the surface: there normals and "
                "curvatures are those of its spline",
            ),
            (MISFIT | {"on": "surface", "fit_angle": 0.03161}, slice(None), START),
            (
                MISFIT | {"on": "spline", "fit_angle": 0.03161}, slice(None),
                f"{START}; they lie on a spline within 1.07e-05 of the surface, its normals within "
                "0.0316°",
            ),
            (
                MISFIT | {"on": "spline"}, slice(None),
                f"{START}; they lie on a spline within 1.07e-05 of the data (root mean square "
                "6.03e-06)",
            ),
            (
                {"surface": "an unknown surface", "normals": None, "patches": None,
                 "developable_share": None, "developable_patches": None}, slice(None),
                "10,012 samples (5,012 with K > 0, 5,000 with K < 0)",
            ),
        ],
    )  # fmt: skip
    def test_summary(self, changes, rows, summary):
        samples = self.samples()
        report = replace(samples.report, **changes)
        assert replace(samples, report=report)[rows].summary() == summary

    @pytest.mark.parametrize(
        ("index", "words"),
        [
            ([0, 1, 1, 0], "4 samples at 2 prescribed normals, exactly 2 each ("),
            ([1, 0], "2 samples at 2 prescribed normals, exactly 1 each ("),
            ([1, 1, 1, 0], "4 samples at 2 prescribed normals ("),
            ([1, 1], "2 samples at 1 of 2 prescribed normals ("),
            ([1, -1], "2 samples: 1 at 1 of 2 prescribed normals, 1 filling gaps ("),
            ([0, 1, 1], "3 samples at 2 prescribed normals ("),
            ([0, 1, -1], "3 samples: 2 at 2 prescribed normals, 1 filling gaps ("),
        ],
    )
    def test_summary_says_if_all_normals_have_equally_many_samples(self, index, words):
        samples = replace(self.samples()[: len(index)], normal_index=np.array(index))
        report = replace(samples.report, normals=2, samples=len(index))
        assert replace(samples, report=report).summary().startswith(words)
        one = replace(report, normals=1)
        first = replace(samples, normal_index=np.zeros(len(index), int), report=one)
        assert first.summary().startswith(f"{len(index)} samples at 1 prescribed normal (")

    def test_summary_of_samples_that_fill_gaps(self):
        indices = np.arange(10012) - 5012
        samples = replace(self.samples(), normal_index=np.maximum(indices, -1))
        assert samples.summary() == (
            f"10,012 samples: 5,000 at 5,000 {OF_ALL}, 5,012 filling gaps "
            "(5,012 with K > 0, 5,000 with K < 0)"
        )
        assert samples[:5012].summary() == (
            "5,012 of 10,012 samples filling gaps (12 with K > 0, 5,000 with K < 0)"
        )
        without = replace(samples, report=replace(samples.report, normals=0))
        assert without[:10].summary() == "10 of 10,012 samples (10 with K < 0)"

    @pytest.mark.parametrize(
        ("changes", "count", "text"),
        [
            # A hundredth is worth a warning.
            ({"developable_share": 0.009}, None, None),
            ({"developable_share": 0.011}, None, "1 % of its area is flat or developable"),
            ({"unrefined": 10}, None, None),
            ({"unrefined": 11}, None, "11 of 1000 samples could not be moved to the surface"),
            # A count is missed by more than two per cent and a few: symmetric surfaces have samples
            # that appear at once.
            ({"samples": 13}, 8, None),
            ({"samples": 15}, 8, "15 samples instead of the requested"),
            ({"samples": 1024}, 1000, None),
            ({"samples": 1026}, 1000, "1026 samples instead of the requested"),
            ({"samples": 976}, 1000, None),
        ],
    )
    def test_what_is_worth_a_warning(self, changes, count, text):
        report = replace(SamplingReport("torus", 500, 1000, 64, 0.0, 0), **changes)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            warn_of(report, count, 1)
        assert [text in str(x.message) for x in caught] == [True] * (text is not None)


class TestAsASequence:
    def test_a_number_picks_one_sample_and_a_loop_goes_through_them(self) -> None:
        samples = torus(12)
        ones = list(samples)
        assert len(ones) == 12
        assert list(samples[:0]) == []
        picked = [(samples[0], 0), (samples[np.int64(5)], 5), (samples[-1], 11)]
        for one, row in [*picked, *((x, k) for k, x in enumerate(ones))]:
            assert isinstance(one, Samples)
            assert len(one) == 1
            for name, array in one.arrays().items():
                np.testing.assert_array_equal(array, samples.arrays()[name][row : row + 1])

    def test_as_an_array_they_are_points(self) -> None:
        samples = torus(12)
        assert np.asarray(samples) is samples.points
        assert np.array(samples) is not samples.points
        assert np.asarray(samples, dtype=np.float32).dtype == np.float32
        assert np.linalg.norm(samples, axis=1).shape == (12,)
        others = Samples(normals=samples.normals, report=REPORT)
        refused("add 'points' to the fields", np.asarray, others, error=gm.errors.MissingFieldError)


# --- parabolic samples: K is zero up to rounding --------------------------------------------------


@pytest.mark.parametrize("factor", [1.0, 1e-9, 1e9, 1e-100])
def test_curved_surfaces_are_not(factor):
    scaled = moved(gm.surfaces.torus(), factor)
    samples = gm.sample(gm.fit(scaled, (16, 16)), 200)
    assert not samples.parabolic.any()
    assert "flat" not in samples.summary()


@pytest.mark.parametrize("height", [1e-3, 1e-6])
def test_gentle_waves_are_curved(height):
    waves = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, height * np.sin(u) * np.cos(v)], axis=-1), ((0, 6), (0, 6))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        assert gm.sample(gm.fit(waves, (32, 32)), 300).parabolic.sum() <= 3


def test_samples_with_few_fields():
    cylinder = gm.fit("cylinder", (16, 16))
    alone = gm.sample(cylinder, 50, fields=("gaussian_curvature",))
    assert alone.parabolic.all()
    with pytest.raises(gm.errors.MissingFieldError, match="parabolic needs gaussian_curvature"):
        gm.sample(cylinder, 50, fields=("points",)).parabolic  # noqa: B018
    rows: dict[str, Any] = {x: y[:0] for x, y in gm.sample(cylinder, 50).arrays().items()}
    assert gm.Samples(**rows, report=alone.report).parabolic.shape == (0,)


# --- some fields, and float32 ---------------------------------------------------------------------

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
