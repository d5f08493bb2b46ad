"""Sampling the parts of a shard: what is done is kept, and what fails is a row of the manifest."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from ...runtime.base.errors import FileError
from .asked import Asked
from .child import Answer, Child, Limits
from .folder import FILES, Settings, read_settings
from .inputs import Input
from .manifest import FAILED, OK, ManifestRow
from .serving import Task
from .shards import Shard

__all__ = ["Plan", "Tally", "file_name", "run_shard"]

# How often a part is tried that fails.
ATTEMPTS = 2
# So many failures are shown when a run ends; the manifest has all.
SHOWN = 10
LONGEST_NAME = 60


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """What all shards of a run have in common.

    Attributes
    ----------
    folder : str
        The absolute path of the data set, the same on all machines.
    settings : Settings
        Those of the data set.
    asked : Asked
        What is asked of each part.
    limits : Limits
        Those of each part.
    again : bool
        Whether parts that failed in an earlier run are tried again.

    """

    folder: str
    settings: Settings
    asked: Asked
    limits: Limits
    again: bool = False


@dataclass(frozen=True, slots=True)
class Tally:
    """What became of parts: how many are sampled, failed, or done by an earlier run.

    `failures` are the names of the first ones, and why.
    """

    ok: int = 0
    failed: int = 0
    kept: int = 0
    samples: int = 0
    seconds: float = 0.0
    failures: tuple[tuple[str, str], ...] = ()

    @property
    def parts(self) -> int:
        """The number of parts."""
        return self.ok + self.failed + self.kept

    def __add__(self, other: Self) -> Tally:
        return Tally(
            self.ok + other.ok,
            self.failed + other.failed,
            self.kept + other.kept,
            self.samples + other.samples,
            self.seconds + other.seconds,
            (self.failures + other.failures)[:SHOWN],
        )


def run_shard(plan: Plan, number: int, inputs: Sequence[Input], child: Child) -> Tally:
    """Do what is missing of a shard, and finish it.

    Raises FileError if the data set cannot be written.
    """
    tally = Tally()
    with Shard(Path(plan.folder), number, plan.settings) as shard:
        before_all = dict(shard.rows)
        for part in inputs:
            before = shard.rows.get(part.part)
            file = _file(plan, part)
            answer, attempts = _tried(plan, part, child, file, _known(plan, part, before, file))
            if answer.same and before is not None:
                tally += _tally(before, kept=True)
                continue
            row = _row(part, answer, attempts)
            if before is None or not _fails_again(before, row):
                shard.add(row, answer.table)
            tally += _tally(row)
        # A worker of Dask that nobody waits for may come after another run.
        if read_settings(plan.folder).to_json() != plan.settings.to_json():
            raise FileError(f"'{plan.folder}' holds another data set by now.")
        shard.commit([part.part for part in inputs])
    _remove_files(plan, before_all, inputs)
    return tally


def file_name(part: int, name: str, suffix: str) -> str:
    """Return the name of the file of a part: its number, and what is harmless of its name."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    clean = re.sub(r"[^A-Za-z0-9_-]+", "-", plain).strip("-")[:LONGEST_NAME]
    return f"{part:06d}{'-' if clean else ''}{clean}{suffix}"


def _file(plan: Plan, part: Input | ManifestRow) -> Path | None:
    suffix = plan.settings.files
    if suffix is None:
        return None
    return Path(plan.folder) / FILES / file_name(part.part, part.name, suffix)


def _remove_files(plan: Plan, before: Mapping[int, ManifestRow], inputs: Sequence[Input]) -> None:
    """Remove the files of parts that are not in the list any more, or have another name now."""
    kept = {_file(plan, part) for part in inputs}
    for file in {_file(plan, row) for row in before.values()} - kept:
        if file is not None:
            file.unlink(missing_ok=True)


def _known(plan: Plan, part: Input, before: ManifestRow | None, file: Path | None) -> str | None:
    """Return the content of a part that need not be done again, if it has not changed."""
    if before is None or (before.name, before.source) != (part.name, part.source):
        return None
    if before.status == FAILED:
        return None if plan.again or not before.content else before.content
    return before.content if file is None or file.exists() else None


def _tried(
    plan: Plan, part: Input, child: Child, file: Path | None, known: str | None
) -> tuple[Answer, int]:
    """Return what became of a part, and after how many attempts."""
    path = None if file is None else str(file)
    task = Task(part, known, plan.asked, plan.settings, plan.limits, path)
    answer, attempts = child.sample(task), 1
    while answer.error and attempts < ATTEMPTS:
        answer, attempts = child.sample(task), attempts + 1
    return answer, attempts


def _row(part: Input, answer: Answer, attempts: int) -> ManifestRow:
    about = answer.about
    return ManifestRow(
        part=part.part,
        name=part.name,
        source=part.source,
        content=about.get("content", ""),
        status=FAILED if answer.error else OK,
        attempts=attempts,
        samples=about.get("samples", 0),
        misfit=about.get("misfit"),
        coverage=about.get("coverage"),
        angle=about.get("angle"),
        seconds=about.get("seconds", 0.0),
        warnings=about.get("warnings", ""),
        error=answer.error,
    )


def _fails_again(before: ManifestRow, row: ManifestRow) -> bool:
    """Say whether a part has failed as in an earlier run, so that nothing is new."""
    then, now = (replace(x, seconds=0.0) for x in (before, row))
    return row.status == FAILED and then == now


def _tally(row: ManifestRow, kept: bool = False) -> Tally:
    failed = row.status == FAILED
    return Tally(
        ok=int(not failed and not kept),
        failed=int(failed),
        kept=int(kept and not failed),
        samples=row.samples,
        seconds=0.0 if kept else row.seconds,
        failures=((row.name, row.error),) if failed else (),
    )
