"""When, of which commit and on which machine a page was measured."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import monotonic

PACKAGES = (
    "numpy", "numba", "scipy", "splipy", "trimesh", "open3d", "pymeshlab", "gmsh",
    "cadquery-ocp-novtk", "geomdl",
)  # fmt: skip


STARTED = monotonic()


def machine() -> list[str]:
    """Return the items of a list in Markdown; the minutes count from the import of this module."""
    minutes = (monotonic() - STARTED) / 60.0
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return [
        f"- {datetime.date.today():%-d %B %Y}, commit {commit()}, in {minutes:.0f} minutes",
        f"- {processor()}, {cores} cores, {memory()}, {platform.system()}",
        f"- Python {platform.python_version()}; {', '.join(versions())}",
    ]


def commit() -> str:
    """Return the commit that is checked out; "unknown" outside a checkout."""
    command = ["git", "describe", "--always", "--dirty"]
    folder = Path(__file__).parent
    found = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return found.stdout.strip() or "unknown"


def processor() -> str:
    """Return the name of the processor."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    names = [x.partition(":")[2].strip() for x in lines if x.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def memory() -> str:
    """Return the size of the memory as text."""
    if not hasattr(os, "sysconf"):
        return "unknown memory"
    size = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return f"{size / 2**30:.0f} GiB of memory"


def versions() -> list[str]:
    """Return the packages that are installed, with their versions."""
    found = []
    for name in PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return found
