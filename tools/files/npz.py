"""NumPy archives of samples: all fields and the report, restored bit for bit."""

from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np

from ...runtime.samples.fields import ARRAY_NAMES
from ...runtime.samples.samples import Samples
from .archives import archive_of
from .content import known_fields, lacks, report_from_json, report_to_json
from .reading import UnusableError

# The version of the format. Raise it when files change so that older versions of gaussmap would
# misread them.
_VERSION = 1


def write_npz(samples: Samples, path: Path) -> None:
    """Write all fields and the report."""
    arrays = {name: getattr(samples, name) for name in samples.fields}
    if samples.fields != ARRAY_NAMES:
        arrays["fields"] = np.array(samples.fields)
    report = np.array(report_to_json(samples.report))
    # The file is opened here, since savez appends .npz to paths that end in .NPZ. savez_compressed
    # is not used: it takes forty times as long, and saves a sixth of the size.
    with open(path, "wb") as file:
        np.savez(file, format_version=np.int64(_VERSION), report=report, **arrays)


def read_npz(file: BufferedReader) -> Samples:
    """Read an archive of `write_npz`; nothing is unpickled."""
    with archive_of(file) as archive:
        names = archive.names
        if "format_version" in names and int(archive.read("format_version")) > _VERSION:
            raise UnusableError("comes from a newer version of gaussmap; update gaussmap.")
        fields = known_fields(archive.read("fields").tolist() if "fields" in names else ARRAY_NAMES)
        missing = [n for n in ("format_version", "report", *fields) if n not in names]
        if missing:
            raise lacks("arrays", missing)
        found = {name: archive.read(name) for name in fields}
        arrays: dict[str, Any] = {
            name: array.astype(array.dtype.newbyteorder("="), copy=False)
            for name, array in found.items()
        }
        return Samples(**arrays, report=report_from_json(str(archive.read("report"))))
