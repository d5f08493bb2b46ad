"""Memory is asked before it is taken: estimates are near the truth, too much is refused.

tracemalloc sees all arrays of NumPy, but not what Qhull takes.
"""

import re
import tracemalloc
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.base import errors, memory
from gaussmap.runtime.base.memory import estimate

from ...refusals import refused
from ...shapes import TORUS

directions = gm.directions
CIRCLE = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)


def sample(name: str, count: int | None, **options: Any) -> gm.Samples:
    """Sample a spline that takes little memory itself."""
    return gm.sample(name, count, cells=(16, 16), **options)


# What is known before anything is done, and what is only known later.
KNOWN: dict[str, Callable[[], Any]] = {
    "icosphere": lambda: gm.icosphere(300),
    "fibonacci": lambda: gm.fibonacci(2_000_000),
    "random": lambda: directions.random(2_000_000),
    "healpix": lambda: directions.healpix(64),
    "circle": lambda: directions.circle(100_000),
    "gauss": lambda: gm.sample("ellipsoid", 300_000, density="gauss"),
    "gauss, float32": lambda: sample(
        "ellipsoid", 200_000, density="gauss", on="spline", fields=("points",), dtype="f4"
    ),
    "balanced": lambda: sample("torus", 20_000),
    "balanced, open": lambda: sample("wavy_graph", 20_000),
    "uniform": lambda: sample("torus", 20_000, density="uniform"),
    "power": lambda: sample("torus", 20_000, density=0.5),
    "aligned": lambda: sample("torus", 50_000, density="aligned"),
    "curve": lambda: gm.curves.sample(CIRCLE, 100_000),
    "cells": lambda: gm.fit("torus", (500, 500)),
}
LATER: dict[str, Callable[[], Any]] = {
    "cap": lambda: directions.cap(gm.fibonacci(200_000), (0, 0, 1), 170.0),
    "polygon": lambda: directions.polygon(gm.fibonacci(500_000), np.eye(3)),
    "normals": lambda: gm.sample("torus", normals=gm.fibonacci(200_000)),
    "normals, float32": lambda: sample(
        "torus", None, normals=gm.fibonacci(200_000), on="spline", fields=("points",), dtype="f4"
    ),
    "icosphere": lambda: gm.sample("torus", normals=gm.icosphere(150), on="spline"),
    "angle": lambda: sample("torus", None, angle=2.0),
    "coverage": lambda: sample("torus", None, coverage=0.02, density="uniform"),
    "mesh": lambda: samples_of("balanced").mesh(),
    "mesh of a grid": lambda: samples_of("aligned").mesh(),
}


@cache
def samples_of(density: str) -> gm.Samples:
    return sample("torus", 20_000, density=density)


def measured(call: Callable[[], Any], monkeypatch: pytest.MonkeyPatch) -> tuple[list[float], float]:
    """Return what is held and needed at each check of a call, in bytes, and its peak."""
    asked: list[float] = []

    def recorded(*arguments: Any) -> float:
        needed = estimate(*arguments)
        asked.append(tracemalloc.get_traced_memory()[0] + needed)
        return needed

    call()
    monkeypatch.setattr(memory, "estimate", recorded)
    tracemalloc.start()
    try:
        held = call()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert held is not None
    return asked, peak


@pytest.mark.parametrize(
    ("known", "name"), [*((True, x) for x in KNOWN), *((False, x) for x in LATER)]
)
@pytest.mark.quick_for("fibonacci", "circle", "uniform", "cap")
def test_estimates_are_near(known: bool, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first one of what is known before, the largest one of what is only known later."""
    asked, peak = measured((KNOWN if known else LATER)[name], monkeypatch)
    assert 0.8 < (asked[0] if known else max(asked)) / peak < 2.0
    assert max(asked) / peak < 2.0


def test_counts_on_parts(parts: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a box, whose faces are flat, samples take two fifths of what is expected of others."""
    asked_for, peak = measured(lambda: gm.sample(parts.box(), 10_000), monkeypatch)
    assert 0.8 < asked_for[0] / peak < 3.0
    assert max(asked_for) / peak < 3.0


# --- what is refused ------------------------------------------------------------------------------

REFUSED = (
    r"^[\d,]+ \w[\w ]* need about [\d,]+\.\d GiB of memory; 1\.0 GiB are free, "
    r"a quarter of which is left to other programs; .*\.$"
)


def test_a_quarter_of_what_is_free_stays_free(one_gib: None) -> None:
    """Other programs need it meanwhile, and the system ends those that use up the memory."""
    each = memory.estimate("normals", 1)
    memory.check_memory("normals", 0.74 * memory.GIB / each)
    refused(REFUSED, memory.check_memory, "normals", 0.76 * memory.GIB / each)


@pytest.fixture
def one_gib(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: memory.GIB)


@pytest.mark.parametrize(
    "arguments",
    [
        ["sample", "torus", "--frequency", "10000", "-o", "a.npz"],
        ["sample", "torus", "--count", "100000000", "--density", "gauss", "-o", "a.npz"],
        ["sample", "torus", "--angle", "0.01", "-o", "a.npz"],
    ],
    ids=lambda x: " ".join(x[2:4]),
)
def test_commands(
    arguments: list[str],
    main: Callable[..., int],
    one_gib: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search(REFUSED.removeprefix("^"), line)
    assert not re.search(r"gm\.|=", line)  # names of Python
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(
    "call",
    [
        lambda: gm.fibonacci(10**8),
        lambda: directions.circle(10**8),
        lambda: gm.sample(TORUS, 10**8, density="gauss"),
        lambda: gm.sample(TORUS, 10**7, density="aligned"),
        lambda: gm.sample(TORUS, 10**7, density="uniform"),
        lambda: gm.sample(TORUS, 10**7, density=0.5),
        lambda: gm.sample(TORUS, coverage=5e-4, density="uniform", cells=(8, 8)),
        lambda: gm.curves.sample(CIRCLE, 10**8),
        lambda: gm.fit(TORUS, (10**4, 10**4)),
        lambda: gm.sample(TORUS, normals=np.eye(3))[np.broadcast_to(np.int8(0), 10**7)],
    ],
)
def test_calls(call: Callable[[], Any], one_gib: None) -> None:
    refused(REFUSED, call)


def test_calls_on_parts(parts: ModuleType, one_gib: None) -> None:
    refused(REFUSED, gm.sample, parts.box(), 10**7)
    refused(REFUSED, gm.sample, parts.box(), coverage=5e-3, density="uniform")


def test_what_is_found_or_given_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Normals are few, their samples are many; samples are there, their mesh is not."""
    few, many, samples = gm.icosphere(50), gm.icosphere(120), gm.sample(TORUS, 2000, cells=(8, 8))
    spline = gm.fit(TORUS, (8, 8))
    monkeypatch.setattr(memory, "UNCHECKED", 0.0)
    monkeypatch.setattr(memory, "free_memory", lambda: 11.0e6)
    assert len(gm.sample(spline, normals=few)) > len(few)
    fields = ("points",)
    assert len(gm.sample(spline, normals=many, fields=fields, dtype="f4")) > len(many)
    for on in (spline, TORUS):
        refused(r"288,\d+ samples need about", gm.sample, on, normals=many)
    monkeypatch.setattr(memory, "free_memory", lambda: 1.0e5)
    for call in (
        samples.mesh,
        lambda: directions.cap(few, (0, 0, 1), 10.0),
        lambda: directions.polygon(few, np.eye(3)),
        lambda: gm.sample(spline, normals=few + 1e-3),
    ):
        refused("need about", call)


def test_little_is_not_looked_up(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> float:
        raise AssertionError

    monkeypatch.setattr(memory, "free_memory", fail)
    assert len(gm.sample(TORUS, 2_000, cells=(16, 16))) == 2_000
    with pytest.raises(AssertionError):
        gm.sample(TORUS, 20_000, cells=(16, 16))


# --- what is free ---------------------------------------------------------------------------------


def test_free_memory_is_less_than_all() -> None:
    assert 2.0**24 < memory.free_memory() < memory.memory_limit() < float("inf")


@pytest.mark.parametrize("inside", [True, False], ids=["of the job", "of the container"])
def test_control_groups(inside: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit of any group that holds the process counts; files that can be dropped are free."""
    groups, proc = tmp_path / "cgroup", tmp_path / "proc"
    job = groups / "user" / "job"
    job.mkdir(parents=True)
    (proc / "self").mkdir(parents=True)
    (proc / "meminfo").write_text("MemTotal: 9000000 kB\nMemAvailable: 700000 kB\n")
    (proc / "self" / "cgroup").write_text("9:pids:/other\n0::/user/job\n")
    (job / "memory.max").write_text("max\n")
    group = job if inside else groups
    (group / "memory.max").write_text("500000000\n")
    (group / "memory.current").write_text("300000000\n")
    (group / "memory.stat").write_text("anon 5\ninactive_file 100000000\n")
    monkeypatch.setattr(memory, "PROC", proc)
    monkeypatch.setattr(memory, "CONTROL_GROUPS", groups)
    assert memory.memory_limit() == 500e6
    assert memory.free_memory() == 300e6
    (group / "memory.max").write_text("900000000000\n")
    assert memory.free_memory() == 700_000 * 1024.0


def test_no_memory_is_an_error() -> None:
    @errors.in_memory
    def hungry() -> None:
        raise MemoryError

    refused("not enough memory", hungry)
