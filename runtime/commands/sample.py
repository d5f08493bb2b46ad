"""`gaussmap sample`."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from ..errors import InputError
from ..fields import checked_fields
from ..files.formats import SUFFIXES, check_fields
from ..files.paths import check_target
from ..sampling import sample
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Sample a surface and write the samples to a file."""
    check_target(options.output, SUFFIXES)
    fields = checked_fields(options.fields.split(",") if options.fields is not None else None)
    check_fields(options.output, fields)
    if options.progressive and not {"points", "normals"} <= {*fields}:
        raise InputError("--progressive needs points and normals among the --fields.")
    dtype = np.float32 if options.float32 else np.float64
    samples = sample(**arguments(options, default_count=10_000), fields=fields, dtype=dtype)
    if options.progressive:
        samples = samples.progressive()
    samples.write(options.output)
    summarize(samples, options)
