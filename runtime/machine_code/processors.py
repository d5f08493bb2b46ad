"""Versions, platform and processor, on which machine code depends besides its sources."""

import os
import sys
import sysconfig
from typing import Any, NamedTuple

import llvmlite
import llvmlite.binding as llvm
import numba

SYSTEMS = ("linux", "darwin", "windows")
# Options of Numba, as environment variables, that change the code or its checks.
CODE_OPTIONS = (
    "CPU_NAME", "CPU_FEATURES", "OPT", "ENABLE_AVX", "LOOP_VECTORIZE", "SLP_VECTORIZE", "DEBUG",
    "DEBUGINFO", "BOUNDSCHECK", "FULL_TRACEBACKS", "ENABLE_PROFILING",
)  # fmt: skip


class Level(NamedTuple):
    """A level of processors of one architecture: processors with all its features run its code."""

    name: str
    """LLVM's name of the processor."""
    features: str
    """LLVM's names of the features that go beyond the architecture."""


V3 = "cx16 sahf popcnt sse3 sse4.1 sse4.2 ssse3 avx avx2 bmi bmi2 f16c fma lzcnt movbe"
# One level per architecture: code for x86-64-v3 runs up to 12 % longer than code that is compiled
# for the processor itself.
LEVELS = {
    "x86_64": Level("x86-64-v3", V3),
    "aarch64": Level("generic", "neon"),
    "arm64": Level("apple-m1", "neon"),
}


def identity() -> dict[str, str]:
    """Return the versions and the platform that machine code depends on.

    Of Numba and llvmlite only the series counts, the first two numbers of the version: releases of
    one series load each other's machine code.
    """
    architecture, _, system = llvm.get_process_triple().partition("-")
    return {
        "numba": _series(numba.__version__),
        "llvmlite": _series(llvmlite.__version__),
        "python": str(sysconfig.get_config_var("SOABI") or sys.implementation.cache_tag),
        "platform": f"{architecture}-{next((x for x in SYSTEMS if x in system), system)}",
    }


def level_here() -> Level | None:
    """Return the level of the architecture of this machine; None if there is none."""
    return LEVELS.get(llvm.get_process_triple().partition("-")[0])


def runs_here(level: Level) -> bool:
    """Return whether this processor has all features of a level."""
    features: Any = llvm.get_host_cpu_features()
    return all(features.get(name) for name in level.features.split())


def changed_options() -> dict[str, str]:
    """Return the environment variables that are set and change the code that Numba generates."""
    names = (f"NUMBA_{name}" for name in CODE_OPTIONS)
    return {name: os.environ[name] for name in names if os.environ.get(name)}


def _series(version: str) -> str:
    return ".".join(version.split(".")[:2])
