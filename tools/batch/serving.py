"""What the process does that samples parts.

It gets pickled tasks on its standard input and answers with lines of JSON on what was its standard
output; what functions of users print goes to standard error. It ends when its input does.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from ..files.processes import end_with_parent, limit

if TYPE_CHECKING:
    from .manifest import ManifestRow

__all__ = ["Task", "main"]

GIB = 2**30


@dataclass(frozen=True, slots=True)
class Task:
    """A part to sample.

    Attributes
    ----------
    input : Input
        The part.
    plan : Plan
        What to sample, and where the data set is.
    known : str
        The content of the part that was sampled already, if it is unchanged; else nothing.
    attempt : int
        How often sampling was tried, this time included.

    """

    input: Any
    plan: Any
    known: str = ""
    attempt: int = 1

    def row(self, about: dict[str, Any]) -> ManifestRow:
        """Return what became of the part."""
        from .manifest import FAILED, OK, ManifestRow

        part, status = self.input, FAILED if about.get("error") else OK
        about = {"content": "", "status": status, "attempts": self.attempt} | about
        return ManifestRow(part.part, part.name, part.source, **about)


def main(memory: float, parent: int) -> None:
    """Answer tasks until there are no more, with at most so many GiB of memory."""
    tasks, answers = _streams()
    end_with_parent("SIGKILL", parent)
    limit(RLIMIT_DATA=int(memory * GIB))
    from ...runtime.sample import sample  # noqa: F401 - which takes its time, and that is not a part's

    _say(answers, {})
    while True:
        try:
            task = pickle.load(tasks)
        except EOFError:
            return
        for about in _answers(task):
            _say(answers, about)


def _say(answers: IO[bytes], about: dict[str, Any]) -> None:
    """Write a line. It is no pickle: what reads it runs no code that a file may hold."""
    answers.write(json.dumps(about).encode() + b"\n")
    answers.flush()


def _streams() -> tuple[IO[bytes], IO[bytes]]:
    """Return the two pipes; nothing else reads or writes them from now on."""
    tasks, answers = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that asks
    return os.fdopen(tasks, "rb"), os.fdopen(answers, "wb")


def _answers(task: Task) -> Iterator[dict[str, Any]]:
    """Yield the content of a part, and numbers of the manifest when its samples are written."""
    from ...runtime.base.errors import GaussmapError

    start = time.perf_counter()
    about: dict[str, Any] = {}
    table = None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            surface, content = _source(task)
            # First of all: it is known then, even if sampling kills this process.
            yield {"content": content}
            if content == task.known:
                return
            about["content"] = content
            more, table = _sampled(surface, task)
            about |= more
        except GaussmapError as error:
            about["error"] = str(error)
        except MemoryError:
            about["error"] = "needs more memory than memory_limit; raise it."
        except Exception as error:  # of what users' functions and files do
            about["error"] = f"{type(error).__name__}: {error}"
    about["warnings"] = "\n".join(dict.fromkeys(str(x.message) for x in caught))
    about["seconds"] = time.perf_counter() - start
    yield about if table is None else _written(task, about, table)


def _written(task: Task, about: dict[str, Any], table: Any) -> dict[str, Any]:  # noqa: ANN401
    """Write the samples of a part, and return numbers of the manifest, or why that failed."""
    from ...runtime.base.errors import FileError
    from .shards import write_part

    plan = task.plan
    try:
        write_part(Path(plan.folder), task.row(about), table, table.schema)
    except FileError as error:
        return {"stop": str(error)}
    return about


def _source(task: Task) -> tuple[Any, str]:
    """Return the part, and what it is known by."""
    from ..cad.inspection import is_part_file
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
    named = replace(task.plan.asked.named, surface=path, quiet=True)
    if is_part_file(path):  # neither of which has cells
        limits = task.plan.limits
        limits = {"time_limit": limits.seconds, "memory_limit": limits.memory}
        named = replace(named, tolerance=None, **limits)
    return surface_of(named), content


def _sampled(source: Any, task: Task) -> tuple[dict[str, Any], Any]:  # noqa: ANN401
    """Return numbers of the manifest, and the table of samples; write the file of the part."""
    from ...runtime.place.on_surface import place_of_samples
    from ...runtime.sample import sample
    from ...runtime.samples.fields import checked_fields
    from ..cad.part import Part
    from ..files.lengths import unit_of
    from ..sources.surface_of import with_tolerance
    from .data_files import points_schema, points_table
    from .plan import normals_in

    asked, settings = task.plan.asked, task.plan.settings
    arguments = dict(asked.arguments)
    part = isinstance(source, Part)
    surface, arguments["cells"] = source, None
    if not part:
        named = replace(asked.named, cells=asked.arguments["cells"], quiet=True)
        surface, arguments["cells"] = with_tolerance(source, named)
    on = "surface" if part else place_of_samples(surface, arguments.get("on"))
    grid = arguments.get("density") == "aligned"
    known = checked_fields(None, on == "surface", grid=grid and not part, part=part)
    samples = sample(
        surface,
        normals=None if asked.normals is None else normals_in(asked.normals),
        fields=tuple(name for name in settings.fields if name in known),
        dtype=settings.dtype,
        threads=1,
        **arguments,
    )
    report = samples.report
    about = {
        "samples": len(samples),
        "unit_of_length": unit_of(samples) or "",
        "misfit": report.fit_distance,
        "coverage": report.coverage,
        "angle": report.angle,
    }
    if asked.measured and len(samples):
        about["coverage"] = samples.coverage(threads=1)
        about["angle"] = samples.normal_deviation(threads=1)
    file = task.plan.file(task.input)
    if file is not None:
        samples.write(file)
    return about, points_table(samples, task.input.part, points_schema(settings))
