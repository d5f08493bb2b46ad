"""Values in messages of errors."""

import gaussmap as gm
import numpy as np
import pytest
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


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a\nb\tc\x1b[31m\x7f", r"a\nb\tc\x1b[31m\x7f"),
        ("\udc80\u2028\u202e", r"\udc80\u2028\u202e"),
        ("Zürich √2 (1\u00a0m)", "Zürich √2 (1\u00a0m)"),
    ],
)
def test_messages_have_one_line_without_control_characters(text: str, said: str) -> None:
    """Paths do not change a terminal."""

    assert errors.clipped(text) == said
    assert str(gm.errors.FileError(text)) == str(gm.GaussmapWarning(text)) == said
    with pytest.raises(gm.GaussmapError) as caught:
        gm.read_samples(f"nowhere/{text}.ply")
    assert said in str(caught.value)
