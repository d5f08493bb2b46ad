"""Types of PyVista for pyright: those of its own import all stubs of VTK, which takes long."""

from typing import Any

def __getattr__(name: str) -> Any: ...  # noqa: ANN401
