"""The machine code of one kernel for one signature, as bytes: an entry.

Unlike Numba's own cache, an entry has neither LLVM's bitcode nor the annotated source: machine code
that is not linked into other functions needs neither. It is loaded without Numba's compiler. Files
of entries are written atomically, and a checksum detects damage.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.compiler import CompileResult

__all__ = [
    "entry_of",
    "kernel_of",
    "key_of",
    "opened",
    "replace_file",
    "sealed",
    "signature_in",
]

CHECKSUM = 32  # bytes of SHA-256
BINARY = getattr(os, "O_BINARY", 0)  # of Windows


def key_of(function: Callable[..., Any], signature: Any) -> str:
    """Return the name of a kernel and the types of its arguments, as a text."""
    types = tuple(getattr(signature, "args", signature))
    return f"{function.__module__}.{function.__qualname__}{types}"


def entry_of(compiled: CompileResult) -> bytes:
    """Return the entry of a kernel that was compiled."""
    library, description, environment, signature, *_, environments = compiled._reduce()
    name, _, (code, _) = library
    return sealed(
        pickle.dumps((name, code, description, environment, signature, environments), protocol=5)
    )


def kernel_of(entry: bytes, context: Any) -> CompileResult | None:
    """Return the kernel of an entry, ready to be called; None if the entry is damaged."""
    found = _content(entry)
    if found is None:
        return None
    name, code, description, environment, signature, environments = found
    codegen = context.codegen()
    library = codegen.create_library(name)
    library.enable_object_caching()
    library._set_compiled_object(code)
    library._finalize_final_module()
    # Numba takes the symbols of a module from its bitcode, which is not here.
    symbols = (description.llvm_cpython_wrapper_name, description.llvm_func_name)
    codegen._engine._defined_symbols.update(symbols)
    entry_point = context.get_executable(library, description, environment)
    for each in environments:
        codegen.set_env(each.env_name, each)
    return CompileResult(
        typing_context=context.typing_context, target_context=context, entry_point=entry_point,
        typing_error=None, type_annotation="", signature=signature, objectmode=False, lifted=(),
        fndesc=description, library=library, call_helper=None, environment=environment,
        metadata=None, reload_init=(), referenced_envs=environments,
    )  # fmt: skip


def signature_in(entry: bytes) -> tuple[str, str, tuple[Any, ...]] | None:
    """Return the module, the name and the types of arguments of the kernel; None if damaged."""
    found = _content(entry)
    if found is None:
        return None
    _, _, description, _, signature, _ = found
    return description.modname, description.qualname, signature.args


def sealed(data: bytes) -> bytes:
    """Return data behind a checksum."""
    return hashlib.sha256(data).digest() + data


def opened(content: bytes) -> bytes | None:
    """Return the data behind a checksum; None if they are damaged."""
    checksum, data = content[:CHECKSUM], content[CHECKSUM:]
    return data if hashlib.sha256(data).digest() == checksum else None


def replace_file(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Write a file atomically, with permissions of at most a mode."""
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex}")
    try:
        with open(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY | BINARY, mode), "wb") as file:
            file.write(content)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _content(entry: bytes) -> tuple[Any, ...] | None:
    data = opened(entry)
    return None if data is None else pickle.loads(data)
