"""Methods that are defined in folders which import that of their class; loaded at first use."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

__all__ = ["Later"]


class Later:
    """A descriptor: a function of another module as a method of a class.

    So a class has methods from modules that import it. The first access replaces the descriptor by
    the function. Its name is that of the method by default.
    """

    def __init__(self, module: str, function: str = "") -> None:
        self.module, self.function = module, function

    def __set_name__(self, owner: type, name: str) -> None:
        self.owner, self.name = owner, name

    def __get__(self, instance: object | None, owner: type | None = None) -> Callable[..., Any]:
        function = getattr(import_module(self.module), self.function or self.name)
        setattr(self.owner, self.name, function)
        return function if instance is None else function.__get__(instance, owner)
