"""The command `gaussmap batch`."""

import json
import time
from dataclasses import asdict, replace
from types import SimpleNamespace
from typing import Any

import click
import numpy as np

from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import InputError
from ...runtime.base.wording import plural
from ...runtime.surface.surfaces import CATALOGUE
from ..batch.inputs import Source
from ..batch.making import make, progress
from ..batch.plan import SECONDS, plan_of
from ..batch.workers import Tally
from ..sources.named import Named
from ..sources.surface_of import surface_of
from .console import complain, say, table
from .part_lists import listed
from .sampled import request_of

# The exit code if parts failed, and the default number of samples.
SOME_FAILED, COUNT = 3, 2048


def run(options: SimpleNamespace) -> None:
    """Sample many parts into a data set."""
    NOTICE.quiet = options.quiet
    parts, named = _parts_of(options)
    request = request_of(options, COUNT)
    fields = None if options.fields is None else options.fields.split(",")
    plan = plan_of(
        request, cells=options.cells, on=options.on, measured=options.measure, fields=fields,
        dtype=np.float32 if options.float32 else np.float64, named=named,
    )  # fmt: skip
    start = time.monotonic()
    try:
        tally = make(
            parts,
            options.output,
            plan,
            request.normals,
            workers=options.workers,
            scheduler=options.scheduler,
            time_limit=SECONDS if options.time_limit is None else options.time_limit,
            memory_limit=options.memory_limit,
            how={"disable": True} if options.quiet else progress(),
            overwrite=options.overwrite,
            again=options.retry_failed,
        )
    except KeyboardInterrupt:
        complain("what is done is kept: the same command goes on with the rest")
        raise
    _report(options, tally, time.monotonic() - start)
    if tally.failed:
        raise click.exceptions.Exit(SOME_FAILED)


def _parts_of(options: SimpleNamespace) -> tuple[list[Source], Named]:
    """Return the parts (surfaces, and names of files), and the options for reading the files."""
    none = dict.fromkeys(("formula", "domain", "time_limit", "memory_limit"))
    own = none | {"quiet": False}  # the settings of a data set do not depend on --quiet
    named = Named.of(SimpleNamespace(**vars(options) | own))
    of_formulas = [
        surface_of(replace(named, formula=formula, domain=options.domain))
        for formula in options.formula
    ]
    if not of_formulas:
        replace(named, domain=options.domain)  # raises an error for a domain
    parts: list[Source] = [
        surface_of(replace(named, surface=text)) if text in CATALOGUE else text
        for text in listed(options.parts, options.list)
    ]
    if not parts + of_formulas:
        raise InputError(
            "there are no parts: name surfaces, files or folders, or give --list or --formula."
        )
    return parts + of_formulas, replace(named, cells=None)


def _report(options: SimpleNamespace, tally: Tally, seconds: float) -> None:
    if options.json:
        say(json.dumps(_as_json(options, tally, seconds)))
    elif not options.quiet:
        table(_rows(options, tally, seconds))


def _as_json(options: SimpleNamespace, tally: Tally, seconds: float) -> dict[str, Any]:
    failures = [{"name": name, "error": error} for name, error in tally.failures]
    told = asdict(tally) | {"seconds": seconds, "failures": failures}
    return {"dataset": options.output, "parts": tally.parts} | told


def _rows(options: SimpleNamespace, tally: Tally, seconds: float) -> list[tuple[str, str]]:
    """Return the rows of the summary: pairs of a name and a sentence."""
    rows = [
        (
            "data set",
            f"{options.output}: {tally.samples:,} samples of {plural(tally.parts, 'part')}",
        ),
        ("sampled", f"{plural(tally.ok, 'part')} in {seconds:.1f} s"),
    ]
    if tally.kept:
        rows.append(("kept", f"{plural(tally.kept, 'part')} of an earlier run"))
    if tally.failed:
        rows.append(("failed", f"{plural(tally.failed, 'part')}; the manifest says why"))
        rows += [(f"  {name}", error) for name, error in tally.failures]
        if tally.failed > len(tally.failures):
            rows.append(("  …", f"and {tally.failed - len(tally.failures):,} more"))
        rows.append(("next", "correct these, and run the same again with --retry-failed"))
    return rows
