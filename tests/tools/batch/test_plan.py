"""The names of files that parts get, and the limits of the processes that sample them."""

import pytest
from gaussmap.runtime.base.memory import GIB, memory_limit
from gaussmap.tools.batch.plan import file_name, limits_of


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("bracket", "000042-bracket.ply"),
        ("../etc/Größe 3,5", "000042-etc-Groe-3-5.ply"),
        ("螺丝", "000042.ply"),
        ("x" * 200, f"000042-{'x' * 60}.ply"),
    ],
)
def test_names_of_files_are_harmless(name: str, expected: str) -> None:
    assert file_name(42, name, ".ply") == expected


@pytest.mark.parametrize("workers", [1, 7])
def test_all_workers_together_leave_memory_to_others(workers: int) -> None:
    limits = limits_of(workers, 600.0, None)
    assert 0.88 < workers * limits.memory * GIB / memory_limit() < 0.92
    assert limits_of(workers, 600.0, 2.0).memory == 2.0
