"""Optional libraries: imported on demand, with an error that names the extra if one is missing."""

import importlib
import importlib.util
from typing import Any

from .errors import MissingExtraError


def check_extra(module: str, extra: str, purpose: str) -> None:
    """Raise MissingExtraError unless a module is installed, without importing it."""
    if importlib.util.find_spec(module) is None:
        raise _missing(module, extra, purpose, "is not installed")


def from_extra(module: str, extra: str, purpose: str) -> Any:  # noqa: ANN401
    """Import a module; MissingExtraError, with the extra that installs it, if that fails."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise _missing(module, extra, purpose, "is not installed") from error
    except (ImportError, OSError) as error:  # OSError: a system library is missing
        raise _missing(module, extra, purpose, f"fails: {error}") from error


def if_installed(module: str) -> Any | None:  # noqa: ANN401
    """Import a module that merely saves time; None if it is missing or its import fails."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError):
        return None


def _missing(module: str, extra: str, purpose: str, reason: str) -> MissingExtraError:
    package = module.replace("_", "-")
    return MissingExtraError(
        f'{purpose} needs {package}, but it {reason}; run: pip install "gaussmap[{extra}]"'
    )
