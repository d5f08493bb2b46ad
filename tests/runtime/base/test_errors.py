"""Values in messages of errors."""

import numpy as np
from gaussmap.runtime.base import errors


class Unprintable:
    """An object whose repr raises."""

    def __repr__(self) -> str:
        raise OSError("no")


def test_values_are_shown_on_one_short_line() -> None:
    assert errors.shown("a") == "'a'"
    assert errors.shown(np.eye(2)) == "array([[1., 0.], [0., 1.]])"
    assert errors.shown(10**5000) == "something of type int"
    assert errors.shown(Unprintable()) == "something of type Unprintable"
    assert len(errors.shown("x" * 1000)) == 60
    assert errors.shown("\ud800").encode() == rb"'\ud800'"
