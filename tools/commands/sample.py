"""The command `gaussmap sample`."""

import tempfile
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.samples.fields import checked_fields
from ...runtime.samples.samples import Samples
from ..cad.inspection import is_part_file
from ..files.formats import check_fields, check_samples_target
from .console import pour, summarize
from .sampled import sampled

STANDARD_OUTPUT = "-"


def run(options: SimpleNamespace) -> None:
    """Sample a surface and write the samples to a file, or to standard output."""
    piped = options.output == STANDARD_OUTPUT
    if piped != (options.format is not None):
        raise InputError("-o - writes to standard output, with --format csv, xyz, ply or npy.")
    if piped:
        with tempfile.TemporaryDirectory() as folder:
            named = SimpleNamespace(**vars(options) | {"output": f"{folder}/a.{options.format}"})
            if options.format == "npy":
                np.save(named.output, _rows(_sampled(named)))
            else:
                _sampled(named).write(named.output, progress=not options.quiet)
            pour(named.output)
        return
    check_samples_target(options.output)
    samples = _sampled(options)
    samples.write(options.output, progress=not options.quiet)
    summarize(samples, options)


def _rows(samples: Samples) -> NDArray[np.floating]:
    """Return points and normals as an array (N, 6)."""
    return np.concatenate([samples.points, samples.normals], axis=1)


def _sampled(options: SimpleNamespace) -> Samples:
    """Return the samples; InputError if the format of the output needs fields that they lack."""
    fields = None if options.fields is None else options.fields.split(",")
    is_part = is_part_file(options.surface)
    written = checked_fields(
        fields, options.on != "spline", part=is_part, edges=options.edges and is_part, given=True
    )
    check_fields("a.xyz" if options.format == "npy" else options.output, written)
    if options.progressive and not {"points", "normals"} <= {*written}:
        raise InputError("--progressive needs points and normals among the --fields.")
    if options.path and (options.progressive or "points" not in written):
        raise InputError("--path needs points among the --fields, and excludes --progressive.")
    dtype = np.float32 if options.float32 else np.float64
    samples, _ = sampled(options, 10_000, fields=fields, dtype=dtype, edges=options.edges)
    if options.progressive:
        samples = samples.progressive(progress=not options.quiet)
    return samples.in_order("path") if options.path else samples
