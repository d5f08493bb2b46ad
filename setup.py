"""The packages of the wheel, and the machine code of its kernels.

The root of the repository is `gaussmap`, folder X is `gaussmap.X`: `packages.find` of
pyproject.toml, which says everything else, cannot put a name in front. Kernels are compiled as C
extensions are: those that usual calls need, or with GAUSSMAP_KERNELS=all all of them; 0 leaves them
to the first calls, in a wheel for all platforms.
"""

import os
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from setuptools import find_namespace_packages, setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

FOLDERS = ("generated", "runtime", "runtime.*", "symbolic", "symbolic.*", "tools", "tools.*")
KERNELS = os.environ.get("GAUSSMAP_KERNELS")
WANTED = KERNELS != "0"


class BuildKernels(build_py):
    """Compile kernels in the folder of which the wheel is made; an editable package has none."""

    def find_package_modules(self, package: str, package_dir: str) -> list[tuple[str, str, str]]:
        """Return the modules of a package: this one is none of them."""
        return [x for x in super().find_package_modules(package, package_dir) if x[1] != "setup"]

    def run(self) -> None:
        """Copy modules, then compile what is not up to date in compiled/."""
        folder = Path(self.build_lib).resolve()
        shutil.rmtree(folder / "gaussmap", ignore_errors=True)  # modules of an earlier build
        super().run()
        if WANTED and not self.editable_mode:
            with suppress(FileNotFoundError):
                shutil.copytree("compiled", folder / "gaussmap" / "compiled")
            command = [sys.executable, "-m", "gaussmap.runtime.machine_code.building"]
            if KERNELS != "all":
                command.append("--usual")
            environment = os.environ | {"PYTHONPATH": str(folder)}
            subprocess.run(command, env=environment, cwd=folder, check=True)
        # Machine code that others can write is not run, and neither should sources be.
        for path in (folder / "gaussmap").rglob("*"):
            path.chmod(path.stat().st_mode & ~0o022)


class WithKernels(Distribution):
    """A wheel with machine code is for one Python and one platform."""

    def has_ext_modules(self) -> bool:
        """Return whether there is machine code."""
        return WANTED


setup(
    distclass=WithKernels,
    cmdclass={"build_py": BuildKernels},
    packages=[
        "gaussmap",
        *(f"gaussmap.{name}" for name in find_namespace_packages(include=FOLDERS)),
    ],
)
