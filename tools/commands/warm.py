"""`gaussmap warm`: all kernels are compiled ahead, by calls of public functions on small surfaces.

Kernels are compiled for the types of their arguments; those that fill the fields of samples, for
each dtype of `sample(..., dtype=...)`.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
from numba.core import config, event

from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import FileError, GaussmapWarning, InputError
from ...runtime.directions import fibonacci, icosphere
from ...runtime.fitting.fit import fit
from ...runtime.machine_code.kept import kept_folder
from ...runtime.sample import sample
from ...runtime.samples.samples import Samples
from ...runtime.stream import sample_stream
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import names, surface
from .. import curves
from ..cad.examples import all_kinds
from ..gauss_map import GaussianImages, parabolic_lines, parabolic_points, split_patch
from ..gauss_map.silhouette import silhouette
from ..support.convolution import convolve
from ..support.function import SupportFunction
from .console import say

__all__ = ["run"]

CELLS = (8, 8)
FEW = 60


class _Counter(event.Listener):
    """Counts the kernels that are compiled, without the functions that they call."""

    def __init__(self) -> None:
        self.depth = self.count = 0

    def on_start(self, event: event.Event) -> None:
        self.count += self.depth == 0
        self.depth += 1

    def on_end(self, event: event.Event) -> None:
        self.depth -= 1


def run(options: SimpleNamespace) -> None:
    """Compile all kernels that neither came with the package nor were compiled here before.

    Raises InputError if NUMBA_DISABLE_JIT is set, FileError if there is no writable folder.
    """
    from tqdm import tqdm

    if config.DISABLE_JIT:  # pyright: ignore[reportAttributeAccessIssue]
        raise InputError("NUMBA_DISABLE_JIT is set: nothing is compiled; unset it.")
    folder = kept_folder()
    if folder is None:
        raise FileError(
            "no folder for compiled kernels can be written; set NUMBA_CACHE_DIR to one that can."
        )
    counter, start, quiet = _Counter(), time.monotonic(), NOTICE.quiet
    NOTICE.quiet = True  # the bar takes its place
    bar = tqdm(WORK, desc="compiling", leave=False, disable=options.quiet or None)
    try:
        with warnings.catch_warnings(), event.install_listener("numba:compile", counter):
            warnings.simplefilter("ignore", GaussmapWarning)
            for work in bar:
                bar.set_postfix_str(work.__name__.strip("_"))
                work()
    finally:
        NOTICE.quiet = quiet
        bar.close()
    if not options.quiet:
        seconds = time.monotonic() - start
        done = f"{counter.count} kernels compiled in {seconds:.0f} s, into {folder}"
        say(done if counter.count else "all kernels were compiled already")


def _surfaces() -> None:
    for name in names():
        fit(surface(name), cells=CELLS).evaluate(0.5, 0.5)
        surface(name).derivatives(0.5, 0.5)


def _normals() -> None:
    for normals in (icosphere(6), fibonacci(300), np.eye(3)):
        for name in ("torus", "sphere"):  # a sphere has poles
            sample(surface(name), normals=normals, cells=CELLS)
    sample(_torus(), count=FEW, density="gauss", cells=CELLS)
    sample(_terrain(), normals=icosphere(6))


def _fields() -> None:
    for shape in (_torus(), fit(_torus(), cells=CELLS)):
        for normals in (icosphere(6), fibonacci(300)):
            sample(shape, normals=normals, dtype=np.float32)
        sample(shape, count=FEW, dtype=np.float32)


def _densities() -> None:
    for density in ("balanced", "aligned", "uniform", 0.5):
        sample(_torus(), count=FEW, density=density, cells=CELLS, relax=1)
    sample(_torus(), angle=20.0, cells=CELLS)
    sample(_torus(), coverage=0.3, cells=CELLS)
    sample(_torus(), coverage=0.3, density="uniform", cells=CELLS)
    sample(_torus(), count=FEW, coverage=0.5, cells=CELLS)
    sample(_torus(), normals=icosphere(3), density="balanced", cells=CELLS)
    for name in ("plane", "cylinder", "sphere"):
        sample(surface(name), count=FEW, cells=CELLS)
    sample(_terrain(), count=FEW)


def _streams() -> None:
    for chunk in sample_stream(_torus(), count=FEW, chunk=20, cells=CELLS):
        chunk.summary()


def _after_sampling() -> None:
    samples = _samples()
    samples.offset(0.1)
    samples.progressive()
    samples.coverage()


def _meshes() -> None:
    sphere, terrain = surface("sphere"), _terrain()
    for samples in (_samples(), sample(terrain, count=FEW), sample(sphere, count=FEW)):
        samples.mesh().summary()
        samples.mesh(prefer="normals")
        samples.weights()
    sample(_torus(), count=500, density="aligned").mesh()  # with samples between its lines


def _silhouettes() -> None:
    silhouette(_torus(), direction=(1, 2, 3), count=FEW, cells=CELLS)


def _support_functions() -> None:
    function = SupportFunction.of_spline(_torus(), cells=CELLS)
    moved = function.offset(0.1).translated((1, 2, 3)).scaled(2.0).reversed()
    ellipsoid = surface("ellipsoid")
    for each in (function, moved, function + SupportFunction.of_spline(ellipsoid, cells=CELLS)):
        each.branches(icosphere(2))
        each.sheets(icosphere(2))
        each.contains(icosphere(2))
    corners, middles = [(3, 0, 0), (0, 3, 0), (0, 0, 3)], [(2, 2, 1), (2, 1, 2), (1, 2, 2)]
    SupportFunction.of_patch([*corners, *middles]).branches([[1, 1, 1]])
    convolve(_torus(), ellipsoid, normals=icosphere(2), cells=CELLS)


def _gaussian_images() -> None:
    images = GaussianImages.of_spline(_torus(), cells=CELLS)
    images.areas.sum()
    images.solid_angles.sum()
    images.sheets(np.eye(3))
    images[7].contains(np.eye(3))
    assert images[7].boundary


def _parabolic_points() -> None:
    parabolic_points(_torus())
    spline = fit(_torus(), cells=CELLS)
    parabolic_points(spline)
    parabolic_lines(spline.control_nets[0])
    split_patch(spline.control_nets[0])


def _curves() -> None:
    def star(t: np.ndarray) -> np.ndarray:
        radius = 1 + np.cos(5 * t) / 5
        return np.stack([radius * np.cos(t), radius * np.sin(t)], axis=-1)

    closed = curves.Curve.from_callable(star, (0.0, 2 * np.pi), periodic=True)
    points = np.stack([np.arange(9.0), np.arange(9.0) ** 2], axis=-1)
    for curve in (closed, curves.Curve.from_points(points)):
        samples = curves.sample(curve, count=FEW)
        curves.polygon_distance(curve.evaluate([0.1, 0.2]), samples.polygon)
    curves.sample(closed, normals=np.eye(2))


def _parts() -> None:
    part = all_kinds()
    samples = sample(part, count=FEW, relax=1)
    samples.coverage()
    samples.weights()
    samples.normal_deviation()
    for density in ("uniform", 0.5):
        sample(part, count=FEW, density=density)
    sample(part, angle=20.0)
    sample(part, coverage=0.3)
    sample(part, normals=icosphere(3))


WORK: tuple[Callable[[], None], ...] = (
    _surfaces, _normals, _fields, _densities, _streams, _after_sampling, _meshes, _silhouettes,
    _support_functions, _gaussian_images, _parabolic_points, _curves, _parts,
)  # fmt: skip


def _torus() -> Surface:
    return surface("torus")


def _samples() -> Samples:
    return sample(_torus(), count=FEW, cells=CELLS)


def _terrain() -> Surface:
    return Surface.from_grid(np.hypot(*np.mgrid[-1:1:8j, -1:1:9j]) ** 3, spacing=(1.0, 1.0))
