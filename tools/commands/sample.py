"""`gaussmap sample`."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from ...runtime.base.errors import InputError
from ...runtime.samples.fields import checked_fields
from ..cad.inspection import is_part_file
from ..files.formats import check_fields, check_samples_target
from .console import summarize
from .inputs import sampled

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Sample a surface and write the samples to a file."""
    check_samples_target(options.output)
    fields = None if options.fields is None else options.fields.split(",")
    is_part = is_part_file(options.surface)
    written = checked_fields(
        fields, options.on != "spline", part=is_part, edges=options.edges and is_part
    )
    check_fields(options.output, written)
    if options.progressive and not {"points", "normals"} <= {*written}:
        raise InputError("--progressive needs points and normals among the --fields.")
    dtype = np.float32 if options.float32 else np.float64
    samples, _ = sampled(options, 10_000, fields=fields, dtype=dtype, edges=options.edges)
    if options.progressive:
        samples = samples.progressive(progress=not options.quiet)
    samples.write(options.output, progress=not options.quiet)
    summarize(samples, options)
