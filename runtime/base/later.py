"""Methods that are defined in modules which import their class; loaded at first use."""

from collections.abc import Callable
from importlib import import_module
from typing import Any


class Later:
    """A descriptor that makes a function of another module a method of a class.

    The module may import the class. The first access to the method imports the module, and replaces
    the descriptor by the function. By default the function has the name of the method.
    """

    def __init__(self, module: str, function: str = "") -> None:
        self.module, self.function = module, function

    def __set_name__(self, owner: type, name: str) -> None:
        self.owner, self.name = owner, name

    def __get__(self, instance: object | None, owner: type | None = None) -> Callable[..., Any]:
        function = getattr(import_module(self.module), self.function or self.name)
        setattr(self.owner, self.name, function)
        return function if instance is None else function.__get__(instance, owner)
