"""Methods that rooms above a class define, loaded when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

__all__ = ["Later"]


class Later:
    """A function of another module as a method of the class that has this.

    So a class has methods of rooms that stand on it, and does not import them. The first use puts
    the function itself into the class. It has the name of the method, unless another one is given.
    """

    def __init__(self, module: str, function: str = "") -> None:
        self.module, self.function = module, function

    def __set_name__(self, owner: type, name: str) -> None:
        self.owner, self.name = owner, name

    def __get__(self, instance: object | None, owner: type | None = None) -> Callable[..., Any]:
        function = getattr(import_module(self.module), self.function or self.name)
        setattr(self.owner, self.name, function)
        return function if instance is None else function.__get__(instance, owner)
