"""The names of files that parts get, and the limits of the processes that sample them."""

import os

import pytest
from gaussmap.tools.batch.plan import file_name, limits_of


@pytest.mark.parametrize(
    ("name", "expected"),
    [("bracket", "000042-bracket.ply"), ("../etc/Größe 3,5", "000042-etc-Groe-3-5.ply"),
     ("螺丝", "000042.ply"), ("x" * 200, f"000042-{'x' * 60}.ply")],
)  # fmt: skip
def test_names_of_files_are_harmless(name: str, expected: str) -> None:
    assert file_name(42, name, ".ply") == expected


@pytest.mark.parametrize("workers", [1, 7])
def test_all_workers_together_leave_memory_to_others(workers: int) -> None:
    installed = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    limits = limits_of(workers, 600.0, None)
    assert limits.memory * workers == pytest.approx(limits_of(1, 600.0, None).memory)
    assert 0.0 < limits.memory * workers < 0.92 * installed
    assert limits_of(workers, 600.0, 2.0).memory == 2.0
