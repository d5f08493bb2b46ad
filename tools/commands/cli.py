"""The program `gaussmap`: runs a command, and reports errors as one line and an exit code.

Results go to standard output; progress, warnings and errors go to standard error. Every error is
one line, with exit code 2; Ctrl-C exits with 130, and a closed pipe on the output with 141.
"""

import sys
import warnings
from collections.abc import Callable, Sequence

import click

from ...runtime.base.errors import GaussmapError, GaussmapWarning
from . import console
from .completion import PROGRAM, completed
from .parser import parser

FAILED, INTERRUPTED, READER_GONE = 2, 130, 141


def main(arguments: Sequence[str] | None = None, ready: Callable[[], object] = bool) -> int:
    """Run the command line with `arguments`, by default those of the process; return the exit code.

    No exception of gaussmap leaves this function, and no SystemExit. `ready` is called before the
    work of a command begins, after its imports.
    """
    try:
        with warnings.catch_warnings(), console.interruptible():
            warnings.simplefilter("always", GaussmapWarning)
            warnings.showwarning = console.show_warning
            try:
                return _run(sys.argv[1:] if arguments is None else [*arguments], ready)
            finally:
                console.flush()
    except click.UsageError as error:
        console.fail(_usage(error))
    except BrokenPipeError:
        console.give_up_output()
        return READER_GONE
    except GaussmapError as error:
        console.fail(str(error))
    except MemoryError:
        console.fail("there is not enough memory for this; use fewer samples or cells.")
    except OSError as error:  # errors of other files are handled where these are read or written
        console.give_up_output()
        console.fail(f"standard output cannot be written: {error.strerror or error}.")
    except KeyboardInterrupt:
        console.complain("interrupted")
        return INTERRUPTED
    return FAILED


def _run(arguments: list[str], ready: Callable[[], object]) -> int:
    program = parser()
    if (code := completed(program)) is not None:
        return code
    try:
        with program.make_context(PROGRAM, arguments or ["--help"], obj=ready) as context:
            program.invoke(context)
    except click.exceptions.Exit as done:  # raised by --help and --version
        return done.exit_code
    return 0


def _usage(error: click.UsageError) -> str:
    """Return the message for an error in the arguments, with a reference to the help."""
    text = error.format_message()
    if isinstance(error, click.BadParameter) and not isinstance(error, click.MissingParameter):
        option = "/".join(error.param.opts) if error.param else ""
        text = f"{option}: {error.message}"
    command = error.ctx.command_path if error.ctx else PROGRAM
    return f"{text[0].lower()}{text[1:].rstrip('.')} (see `{command} --help`)"
