"""The machine code of one kernel for one signature, as bytes: an entry.

Unlike in Numba's own cache, an entry is not a pickle, and has neither bitcode nor annotated source
text: machine code that is not linked into other functions needs neither. An entry consists of a
checksum, which detects damage, the size of a head, the head, and the object code. The head (JSON)
has names and types. An entry is loaded without Numba's compiler. Files of entries are written
atomically.
"""

import hashlib
import json
import os
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.compiler import CompileResult
from numba.core.environment import _rebuild_env
from numba.core.funcdesc import PythonFunctionDescriptor
from numba.core.typing.templates import signature as signature_of

from .signatures import as_json, as_types

CHECKSUM = 32  # bytes of SHA-256
WORD = 8  # bytes of the size of a head
BINARY = getattr(os, "O_BINARY", 0)  # exists on Windows only


def key_of(function: Callable[..., Any], signature: Any) -> str:
    """Return the name of a kernel and the types of its arguments, as a text."""
    types = tuple(getattr(signature, "args", signature))
    return f"{function.__module__}.{function.__qualname__}{types}"


def entry_of(compiled: CompileResult) -> bytes:
    """Return the entry of a kernel that was compiled.

    Raises TypeError for types that no kernel of this package has, and for code that refers to
    Python objects.
    """
    library, description, _, signature, *_, environments = compiled._reduce()
    name, _, (code, _) = library
    if any(x.consts for x in environments):
        raise TypeError(f"{name} has constants of Python")
    head = {
        "library": name,
        "module": description.modname,
        "name": description.qualname,
        "symbol": description.mangled_name,
        "environment": description.env_name,
        "environments": [(x.globals["__name__"], x.env_name) for x in environments],
        "types": [as_json(x) for x in signature.args],
        "returns": as_json(signature.return_type),
    }
    text = json.dumps(head).encode()
    return sealed(len(text).to_bytes(WORD, "little") + text + code)


def kernel_of(entry: bytes, context: Any) -> CompileResult | None:
    """Return the kernel of an entry, ready to be called; None if the entry is damaged."""
    found = _content(entry)
    if found is None:
        return None
    head, code = found
    signature = signature_of(as_types(head["returns"]), *map(as_types, head["types"]))
    description = PythonFunctionDescriptor(
        native=True, modname=head["module"], qualname=head["name"], unique_name=head["name"],
        doc="", typemap=None, restype=signature.return_type, calltypes=None, args=(), kws=(),
        mangler=lambda *_, **__: head["symbol"], argtypes=signature.args,
        env_name=head["environment"],
    )  # fmt: skip
    codegen = context.codegen()
    library = codegen.create_library(head["library"])
    library.enable_object_caching()
    library._set_compiled_object(code)
    library._finalize_final_module()
    # Numba takes the symbols of a module from its bitcode, which an entry does not have.
    symbols = (description.llvm_cpython_wrapper_name, description.llvm_func_name)
    codegen._engine._defined_symbols.update(symbols)
    environments = [_rebuild_env(module, [], name) for module, name in head["environments"]]
    own = _rebuild_env(head["module"], [], head["environment"])
    entry_point = context.get_executable(library, description, own)
    for each in environments:
        codegen.set_env(each.env_name, each)
    return CompileResult(
        typing_context=context.typing_context, target_context=context, entry_point=entry_point,
        typing_error=None, type_annotation="", signature=signature, objectmode=False, lifted=(),
        fndesc=description, library=library, call_helper=None, environment=own,
        metadata=None, reload_init=(), referenced_envs=environments,
    )  # fmt: skip


def signature_in(entry: bytes) -> tuple[str, list[Any]] | None:
    """Return the name of the kernel and the types of its arguments, as JSON; None if damaged."""
    found = _content(entry)
    return (
        None if found is None else (f"{found[0]['module']}.{found[0]['name']}", found[0]["types"])
    )


def sealed(data: bytes) -> bytes:
    """Return data with their checksum in front."""
    return hashlib.sha256(data).digest() + data


def opened(content: bytes) -> bytes | None:
    """Return the data that follow a checksum; None if they are damaged."""
    checksum, data = content[:CHECKSUM], content[CHECKSUM:]
    return data if hashlib.sha256(data).digest() == checksum else None


def replace_file(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Write a file atomically; its permissions are at most `mode`."""
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex}")
    try:
        with open(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY | BINARY, mode), "wb") as file:
            file.write(content)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _content(entry: bytes) -> tuple[dict[str, Any], bytes] | None:
    """Return the head and the code of an entry; None if it is damaged, or of another format."""
    data = opened(entry) or b""
    end = WORD + int.from_bytes(data[:WORD], "little")
    try:
        return json.loads(data[WORD:end]), data[end:]
    except ValueError:
        return None
