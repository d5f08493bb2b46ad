"""What the process does that samples parts.

It gets pickled tasks on its standard input and answers with frames on what was its standard output;
what functions of users print goes to standard error. It ends when its input does.
"""

from __future__ import annotations

import os
import pickle
import signal
import time
import warnings
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import IO, Any

__all__ = ["Task", "main"]

GIB = 2**30
# Of Linux: the signal that a process gets when its parent ends.
PR_SET_PDEATHSIG = 1


@dataclass(frozen=True, slots=True)
class Task:
    """A part to sample.

    Attributes
    ----------
    input : Input
        The part.
    known : str or None
        The content of the part that was sampled already, if it is unchanged.
    asked : Asked
        What to sample.
    settings : Settings
        Those of the data set.
    limits : Limits
        Those of this process, which reading a CAD file has, too.
    file : str or None
        The path of the file of its own that the part gets.

    """

    input: Any
    known: str | None
    asked: Any
    settings: Any
    limits: Any
    file: str | None = None


def main(memory: float, parent: int) -> None:
    """Answer tasks until there are no more, with at most so many GiB of memory."""
    tasks, answers = _streams()
    _end_with_parent(parent)
    _limit_memory(memory)
    from ...runtime.sample import sample  # noqa: F401 - which takes its time, and that is not a part's
    from .frames import write_frame

    write_frame(answers, {})
    while True:
        try:
            task = pickle.load(tasks)
        except EOFError:
            return
        # First the content: it is known then, even if sampling kills this process.
        for about, table in _answers(task):
            write_frame(answers, about, table)


def _streams() -> tuple[IO[bytes], IO[bytes]]:
    """Return the two pipes; nothing else reads or writes them from now on."""
    tasks, answers = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that asks
    return os.fdopen(tasks, "rb"), os.fdopen(answers, "wb")


def _answers(task: Task) -> Any:  # noqa: ANN401
    """Yield the content of a part, and what became of it, with a table of its samples."""
    from ...runtime.base.errors import GaussmapError

    start = time.perf_counter()
    about: dict[str, Any] = {}
    table = None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            surface, content = _source(task)
            yield {"content": content}, None
            if content == task.known:
                yield {"same": True}, None
                return
            about, table = _sampled(surface, task)
        except GaussmapError as error:
            about = {"error": str(error)}
        except MemoryError:
            about = {"error": "needs more memory than memory_limit; raise it."}
        except Exception as error:  # of what users' functions and files do
            about = {"error": f"{type(error).__name__}: {error}"}
    about["seconds"] = time.perf_counter() - start
    about["warnings"] = "\n".join(dict.fromkeys(str(x.message) for x in caught))
    yield about, table


def _source(task: Task) -> tuple[Any, str]:
    """Return the part, and what it is known by."""
    from ..cad.part_files import is_part_file
    from ..files.numpy_files import array_file
    from ..sources.surface_of import surface_of
    from .inputs import content_of

    path = task.input.path
    if path is None:
        surface = pickle.loads(task.input.pickled)
        return surface, content_of(surface)
    content = content_of(array_file(path))
    if content == task.known:
        return None, content
    named = replace(task.asked.named, surface=path, quiet=True)
    if is_part_file(path):  # neither of which has cells
        limits = {"time_limit": task.limits.seconds, "memory_limit": task.limits.memory}
        named = replace(named, tolerance=None, **limits)
    return surface_of(named), content


def _sampled(source: Any, task: Task) -> tuple[dict[str, Any], Any]:  # noqa: ANN401
    """Return numbers of the manifest, and the table of samples; write the file of the part."""
    from ...runtime.place.on_surface import place_of_samples
    from ...runtime.sample import sample
    from ...runtime.samples.fields import checked_fields
    from ..cad.part import Part
    from ..sources.surface_of import with_tolerance
    from .arrow_tables import points_schema, points_table
    from .asked import normals_in

    arguments = dict(task.asked.arguments)
    part = isinstance(source, Part)
    surface, arguments["cells"] = source, None
    if not part:
        named = replace(task.asked.named, cells=task.asked.arguments["cells"], quiet=True)
        surface, arguments["cells"] = with_tolerance(source, named)
    on = "surface" if part else place_of_samples(surface, arguments.get("on"))
    grid = arguments.get("density") == "aligned"
    known = checked_fields(None, on == "surface", grid=grid and not part, part=part)
    samples = sample(
        surface,
        normals=None if task.asked.normals is None else normals_in(task.asked.normals),
        fields=tuple(name for name in task.settings.fields if name in known),
        dtype=task.settings.dtype,
        threads=1,
        **arguments,
    )
    report = samples.report
    about = {
        "samples": len(samples),
        "misfit": report.fit_distance,
        "coverage": report.coverage,
        "angle": report.angle,
    }
    if task.asked.measured and len(samples):
        about["coverage"] = samples.coverage(threads=1)
        about["angle"] = samples.normal_deviation(threads=1)
    if task.file is not None:
        samples.write(task.file)
    return about, points_table(samples, task.input.part, points_schema(task.settings))


def _end_with_parent(parent: int) -> None:
    """Let the system end this process when that which waits for it is killed, where it can."""
    with suppress(AttributeError, OSError, TypeError):
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # it was killed before
            os._exit(1)


def _limit_memory(gib: float) -> None:
    with suppress(ImportError, OSError, ValueError):  # some systems have no limits
        import resource

        for kind, limit in ((resource.RLIMIT_DATA, int(gib * GIB)), (resource.RLIMIT_CORE, 0)):
            _, hard = resource.getrlimit(kind)
            low = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
            resource.setrlimit(kind, (low, hard))
