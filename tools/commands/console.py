"""Writing to standard output and standard error, and handling of Ctrl-C."""

from __future__ import annotations

import _thread
import os
import shutil
import sys
import textwrap
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TextIO

from ...runtime.base.errors import printable

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples
    from ..meshes.mesh import Mesh


def say(text: str) -> None:
    """Print to standard output."""
    write(text, sys.stdout)


def summarize(result: Samples | Mesh, options: SimpleNamespace) -> None:
    """Print the name of the output file and the summary of its contents, unless --quiet is set."""
    if not options.quiet:
        say(printable(f"{options.output}: {result.summary()}"))


def table(rows: Iterable[tuple[str, str]]) -> None:
    """Print a name and a sentence for each row; on a terminal, sentences are wrapped."""
    pairs = [(printable(name), printable(sentence)) for name, sentence in rows]
    width = max(len(name) for name, _ in pairs) + 2
    for name, sentence in pairs:
        line = f"{name:{width}}{sentence}"
        if sys.stdout is not None and sys.stdout.isatty():
            columns = max(shutil.get_terminal_size().columns, width + 20)
            line = textwrap.fill(line, columns, subsequent_indent=" " * width)
        say(line)


def complain(text: str) -> None:
    """Print one line to standard error, unless standard error is closed."""
    with suppress(OSError, ValueError):
        write(f"gaussmap: {' '.join(text.split())}", sys.stderr)


def fail(message: str) -> None:
    """Print an error."""
    complain(f"error: {message}")


def show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning; replaces `warnings.showwarning`."""
    complain(f"warning: {message}")


def write(text: str, stream: TextIO | None) -> None:
    """Print a text to a stream, unless it is None, with `?` for characters not in its encoding."""
    if stream is not None:
        encoding = stream.encoding or "utf-8"
        print(text.encode(encoding, "replace").decode(encoding), file=stream)


def pour(path: str) -> None:
    """Write a file to standard output, byte by byte."""
    if sys.stdout is not None:
        sys.stdout.flush()
        with open(path, "rb") as file:
            shutil.copyfileobj(file, sys.stdout.buffer)
        sys.stdout.buffer.flush()


def flush() -> None:
    """Flush standard output, so that its errors are raised now."""
    if sys.stdout is not None:
        sys.stdout.flush()


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C work during compilation, where a callback from LLVM swallows KeyboardInterrupt."""
    previous = sys.unraisablehook
    again: list[threading.Timer] = []

    def interrupt_again(unraisable: Any) -> None:  # noqa: ANN401
        if unraisable.exc_type is KeyboardInterrupt:
            again.append(threading.Timer(0.1, _thread.interrupt_main))
            again[-1].start()
        else:
            previous(unraisable)

    sys.unraisablehook = interrupt_again
    try:
        yield
    except Exception as error:
        if again:  # the interrupt may have caused an error of the compiler
            raise KeyboardInterrupt from error
        raise
    finally:
        sys.unraisablehook = previous
        for timer in again:
            timer.cancel()


def give_up_output() -> None:
    """Discard the rest of standard output, so that Python reports no error about it at exit."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
