"""The loop of the process that samples parts.

It receives pickled tasks through a pipe and answers with JSON texts; the output of users' functions
goes to standard error. It ends when the pipe is closed.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from ..files.processes import end_with_parent, limit

if TYPE_CHECKING:
    from .inputs import Input
    from .manifest import ManifestRow
    from .plan import Plan

GIB = 2**30
# The statuses besides "ok" and "failed": KEPT if the part is unchanged, and STOPPED if its samples
# cannot be written.
KEPT, STOPPED = "kept", "stopped"


@dataclass(frozen=True, slots=True)
class Task:
    """A part to sample.

    Attributes
    ----------
    input : Input
        The part.
    plan : Plan
        The plan of the run.
    before : ManifestRow or None
        The row of the part from an earlier run; the part is kept if its content is the same.
    again : bool
        Whether this is a second attempt.

    """

    input: Input
    plan: Plan
    before: ManifestRow | None = None
    again: bool = False

    def row(self, about: dict[str, Any]) -> ManifestRow:
        """Return the manifest row of the part, with the results in `about`."""
        from .manifest import ManifestRow

        return ManifestRow(self.input.part, self.input.name, self.input.source, **about)


def serve(pipe: Connection, memory: float, parent: int) -> None:
    """Sample the parts of tasks until the pipe is closed, with at most `memory` GiB of memory."""
    end_with_parent("SIGKILL", parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent process
    limit(RLIMIT_DATA=int(memory * GIB))
    os.dup2(2, 1)
    from ..sampling.sample import sample  # noqa: F401 - loaded before a part's time limit begins

    _say(pipe, {})
    while True:
        try:
            task = pickle.loads(pipe.recv_bytes())
        except EOFError:
            return
        for about in _answers(task):
            _say(pipe, about)


def _say(pipe: Connection, about: dict[str, Any]) -> None:
    """Send results as a JSON text, which runs no code when it is read, unlike a pickle."""
    pipe.send_bytes(json.dumps(about).encode())


def _answers(task: Task) -> Iterator[dict[str, Any]]:
    """Yield the columns that identify a part, then its results once its samples are written."""
    from ...runtime.base.errors import FileError, GaussmapError
    from .manifest import FAILED, OK
    from .part_files import write_part

    about: dict[str, Any] = {"status": FAILED}
    samples = None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            surface, known = _source(task)
            # These columns are sent first, so that the parent has them even if sampling kills this
            # process.
            yield known
            if task.before is not None and known["content"] == task.before.content:
                yield {"status": KEPT}
                return
            more, samples = _sampled(surface, task)
            about = {"status": OK} | known | more
        except GaussmapError as error:
            about["error"] = str(error)
        except MemoryError:
            about["error"] = "needs more memory than memory_limit; raise it."
        except Exception as error:  # users' functions and files may raise anything
            about["error"] = f"{type(error).__name__}: {error}"
    about["warnings"] = "\n".join(dict.fromkeys(str(x.message) for x in caught))
    if samples is not None:
        try:
            write_part(task.plan.folder, task.plan.settings, task.row(about), samples)
        except FileError as error:
            about = {"status": STOPPED, "error": str(error)}
    yield about


def _source(task: Task) -> tuple[Any, dict[str, str]]:
    """Return the surface of a part, and the columns of the manifest that identify the part.

    The surface is None if the file of the part has not changed.
    """
    from ..cad.inspection import is_part_file
    from ..files.numpy_files import array_file
    from ..sources.surface_of import surface_of
    from .inputs import content_of, parameters_of

    path = task.input.path
    if path is None:
        surface = pickle.loads(task.input.pickled)
        return surface, {"content": content_of(surface), "parameters": parameters_of(surface)}
    known = {"content": content_of(array_file(path))}
    if task.before is not None and known["content"] == task.before.content:
        return None, known
    named = replace(task.plan.named, surface=path, quiet=True)
    if is_part_file(path):  # the tolerance is for the splines of surfaces only
        plan = task.plan
        named = replace(named, tolerance=None, time_limit=plan.seconds, memory_limit=plan.memory)
    return surface_of(named), known


def _sampled(source: Any, task: Task) -> tuple[dict[str, Any], Any]:  # noqa: ANN401
    """Return the results of a part for its row of the manifest, and its samples."""
    from ...runtime.onto_surface.on_surface import place_of_samples
    from ...runtime.samples.fields import checked_fields
    from ..cad.part import Part
    from ..sampling.sample import sample
    from ..sources.surface_of import with_tolerance

    plan, settings = task.plan, task.plan.settings
    arguments = dict(plan.arguments)
    part = isinstance(source, Part)
    if part:
        surface, arguments["cells"] = source, None
    else:
        named = replace(plan.named, cells=arguments["cells"], quiet=True)
        surface, arguments["cells"] = with_tolerance(source, named)
    on = "surface" if part else place_of_samples(surface, arguments.get("on"))
    density, normals = arguments.get("density"), plan.normals()
    grid, given = density == "aligned" and not part, normals is not None and density == "gauss"
    known = checked_fields(None, on == "surface", grid=grid, part=part, given=given)
    samples = sample(
        surface,
        normals=normals,
        fields=tuple(name for name in settings.fields if name in known),
        dtype=settings.dtype,
        threads=1,
        **arguments,
    )
    report = samples.report
    about = {
        "samples": len(samples),
        "unit_of_length": samples.report.unit or "",
        "misfit": report.fit_distance,
        "coverage": report.coverage,
        "angle": report.angle,
    }
    if plan.measured and len(samples):
        about["coverage"] = samples.coverage(threads=1)
        about["angle"] = samples.normal_deviation(threads=1).normal_space
    return about, samples
