"""The packages of the wheel: the root of the repository is `gaussmap`, folder X is `gaussmap.X`.

pyproject.toml says everything else; its `packages.find` cannot put a name in front.
"""

from setuptools import find_namespace_packages, setup

FOLDERS = ("generated", "runtime", "runtime.*", "symbolic", "symbolic.*", "tools", "tools.*")

setup(
    packages=[
        "gaussmap",
        *(f"gaussmap.{name}" for name in find_namespace_packages(include=FOLDERS)),
    ]
)
