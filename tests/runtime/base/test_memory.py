"""What needs more memory than there is, is refused in one sentence."""

import gaussmap as gm
import pytest
from gaussmap.runtime.base import errors, memory

TORUS = gm.surfaces.torus()


def test_too_little_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 2.0**24 < memory.memory_limit() < float("inf")
    with pytest.raises(gm.errors.InputError, match="at most 1,000,000,000 cells"):
        gm.fit(TORUS, (10**6, 10**6))
    with pytest.raises(gm.errors.InputError, match="at most 1,000,000,000"):
        gm.sample(TORUS, count=10**13)

    monkeypatch.setattr(memory, "memory_limit", lambda: 2.0**30)
    for call in (
        lambda: gm.fit(TORUS, (10**4, 10**4)),
        lambda: gm.sample(TORUS, 10**8, cells=(8, 8)),
        lambda: gm.sample(TORUS, 10**8, cells=(8, 8), density="gauss"),
    ):
        with pytest.raises(
            gm.errors.InputError,
            match=r"(cells|samples) need at least \d+ GiB of memory, and there are 1.0 GiB",
        ):
            call()
    assert len(gm.sample(TORUS, 10, cells=(8, 8))) == 10


def test_no_memory_is_an_error() -> None:
    @errors.in_memory
    def hungry() -> None:
        raise MemoryError

    with pytest.raises(gm.errors.InputError, match="not enough memory"):
        hungry()
