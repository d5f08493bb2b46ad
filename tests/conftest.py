"""What all tests share: which of them are slow, and how many random examples they try."""

import gc
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import settings

# `make test` tries few random examples, and `make verify` many (--hypothesis-profile=large).
settings.register_profile("quick", max_examples=20, deadline=None)
settings.register_profile("large", max_examples=200, deadline=None)
settings.load_profile("quick")

HERE = Path(__file__).parent
# Files of tests that run formulas and kernels: `make coverage` runs them without compilation, but
# for tests marked `compiled`, and reads no other file. In the files of SOME it runs only the tests
# marked `kernels`.
OF_KERNELS = (
    "generated", "tools/curves", "tools/density", "tools/gauss_map", "runtime/tape", "tools/meshes",
    "tools/support", "runtime/search/test_search.py", "runtime/search/test_wide_integers.py",
    "runtime/proof/test_proved_small.py",
    "runtime/surface/test_nurbs.py", "runtime/spline/test_spline.py",
)  # fmt: skip
SOME = (
    "runtime/directions/test_sets.py", "runtime/domain/test_trim.py",
    "runtime/onto_surface/test_refinement.py", "runtime/search/test_exact.py",
    "runtime/spline/test_developable.py", "symbolic/test_emit.py",
    *(f"tools/density/test_{name}.py" for name in (
        "aligned", "cover", "density", "voronoi",
    )),
    "tools/gauss_map/test_parabolic.py", "tools/gauss_map/test_silhouette.py",
    "tools/meshes/test_weights.py",
    *(f"tools/support/test_{name}.py" for name in (
        "convolution", "support", "support_operations",
    )),
)  # fmt: skip
# What `make verify` runs, and `make test` does not even read: pages, pictures and measurements.
SLOW = ("docs", "benchmarks")


def pytest_configure(config: pytest.Config) -> None:
    for marker in (
        "compiled: `make coverage` leaves it out of a file of OF_KERNELS",
        "kernels: `make coverage` runs it without compilation",
        "quick_for(*ids): slow, but for the parameters with one of these ids",
        "slow: takes long and seldom fails; run by `make verify`, and not by `make test`",
    ):
        config.addinivalue_line("markers", marker)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    # Collected tests, modules and formulas stay until the end: there is no garbage among them, and
    # looking for it again and again took a fifth of the time of all tests.
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
        gc.set_threshold(20_000, 20, 50)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    asked, place = config.option.markexpr, collection_path.relative_to(HERE).as_posix()
    if asked == "not slow" and place.startswith(SLOW):
        return True
    if not asked.startswith("kernels") or collection_path.is_dir():
        return None
    return not place.startswith((*OF_KERNELS, *SOME)) or None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        place = item.path.relative_to(HERE).as_posix()
        if place.startswith(OF_KERNELS) and not place.startswith(SOME):
            item.add_marker("kernels")
        if place.startswith(SLOW):
            item.add_marker("slow")
        quick = item.get_closest_marker("quick_for")
        if quick and not set(quick.args).intersection(item.name[:-1].split("[", 1)[1].split("-")):
            item.add_marker("slow")


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a data set of three surfaces."""
    import gaussmap as gm

    path = tmp_path_factory.mktemp("data") / "dataset"
    surfaces = ["torus", "sphere", "ellipsoid"]
    gm.sample_many(surfaces, 500, cells=(16, 16), out=path, workers=1, progress=False)
    return path


@pytest.fixture(scope="session")
def main() -> Callable[..., int]:
    """The command line in this process: it takes the arguments, and returns the exit code."""
    from gaussmap.tools.commands.cli import main

    return main


@pytest.fixture(scope="session")
def parts() -> ModuleType:
    """Functions that return CAD parts made of numbers: no public one does without a file."""
    from gaussmap.tools.cad import examples

    return examples


@pytest.fixture
def unproved(monkeypatch: pytest.MonkeyPatch) -> None:
    """All surfaces are those without bounds of derivatives: samples are moved from the spline."""
    import gaussmap as gm
    from gaussmap.runtime.onto_surface import proved
    from gaussmap.tools.sampling import sample, stream

    def made(surface: gm.Surface, cells: tuple[int, int] | None, on: str | None) -> gm.GaussMap:
        return gm.GaussMap(surface, cells=cells, on=on)

    monkeypatch.setattr(proved, "index_of", lambda surface: None)
    monkeypatch.setattr(sample, "kept_map", made)
    monkeypatch.setattr(stream, "kept_map", made)
