"""The command `gaussmap support`."""

from types import SimpleNamespace

import numpy as np

from ...runtime.base.errors import printable
from ...runtime.base.progress import busy
from ...runtime.base.wording import plural
from ...runtime.directions.unit import as_normals
from ...runtime.map import GaussMap
from ...runtime.samples.report import SamplingReport
from ...runtime.samples.samples import Samples
from ..cad.part import Part
from ..files.formats import check_samples_target
from .console import say
from .sampled import named_normals, named_surface, spare_inputs

AXES = np.concatenate([0.0 - np.eye(3), np.eye(3)])


def run(options: SimpleNamespace) -> None:
    """Write the farthest points of a surface to a file."""
    check_samples_target(options.output)
    spare_inputs(options)
    surface, cells = named_surface(options)
    given = named_normals(options)
    normals = as_normals(AXES if given is None else given)
    with busy("searching", not options.quiet):
        known = GaussMap(surface, cells=cells, on=options.on)
        found = known.support(normals)
        about = known.points(normals[:1], fields=["points"]).report
    place = {x: getattr(about, x) for x in ("on", "unit", "crs", "origin")}
    count, part = len(normals), surface if isinstance(surface, Part) else None
    samples = Samples(
        points=found.points, normals=normals, support=found.values, uv=found.uv,
        normal_index=np.arange(count), face_index=None if part is None else found.face_index,
        report=SamplingReport(about.surface, count, count, None, None, None, **place),
        surface=part,
    )  # fmt: skip
    samples.write(options.output, progress=not options.quiet)
    if not options.quiet:
        points = plural(count, "farthest point")
        errors = f"{found.errors.max():.2g} {about.unit or ''}".rstrip()
        say(printable(f"{options.output}: {points} of {about.surface}, to {errors} along n"))
