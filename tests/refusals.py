"""What holds of every refusal: the kind of error, what it says, and that it is one short line."""

from collections.abc import Callable
from typing import Any

import gaussmap as gm
import pytest


def refused(
    match: str,
    call: Callable[..., Any],
    /,
    *arguments: Any,
    error: type[Exception] = gm.errors.InputError,
    **named: Any,
) -> str:
    """Check that a call raises an error that says `match`, and return what it says."""
    with pytest.raises(error, match=match or None) as caught:
        call(*arguments, **named)
    message = str(caught.value)
    if isinstance(caught.value, gm.GaussmapError):
        assert "\n" not in message
        assert len(message) <= 300
    return message
