"""Print docs/registration.md: samples for registration, by the ICP of Open3D."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import gaussmap as gm
import numpy as np
from gaussmap.benchmarks.peers.machine import machine
from gaussmap.docs.orders import Array, listed, markdown, wrapped

SEEDS = 50
SCAN = 40_000  # points of a scan
NOISE = 0.05  # mm, in each coordinate
SIZE = 100.0  # mm, of the plates
RADIUS = 1000.0  # mm, of the plates
COUNTS = (100, 500, 5_000)
COUNT = 500  # where one is enough
TURN = 1.0  # degrees, of a start about a random axis
LIFT = 0.5  # mm, of a start upwards or downwards at most
SLIDES = (1.0, 4.0, 8.0)  # mm, of a start along each side at most
REACH = 10.0  # mm: points that are farther apart are no pair
NEIGHBOURS = 20  # of a point of the scan, for its normal
FAILED = 0.5  # mm, of the mean error of the points of the part
DENSITIES = ("uniform", "gauss", "balanced")
THEN = " → "
PLANS = (*DENSITIES, f"uniform{THEN}gauss", f"uniform{THEN}balanced")


# --- parts and scans ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Part:
    """A part in mm round the origin: its surface, its cells, and places of it, uniform by area."""

    title: str
    surface: gm.Surface
    places: Callable[[np.random.Generator, int], Array]
    cells: tuple[int, int] = (128, 128)


def plate(title: str, relief: Callable[[Array, Array], Array]) -> Part:
    """Return a plate, a part of a paraboloid with a relief on it."""

    def position(u: Array, v: Array) -> Array:
        return np.stack([u, v, relief(u, v) - (u * u + v * v) / (2.0 * RADIUS)], axis=-1)

    def places(rng: np.random.Generator, count: int) -> Array:
        # Slopes are below 0.4: what is uniform by x and y is so by area within 8 %.
        return position(*rng.uniform(-SIZE / 2, SIZE / 2, (2, count)))

    domain = ((-SIZE / 2, SIZE / 2), (-SIZE / 2, SIZE / 2))
    return Part(title, gm.Surface.from_callable(position, domain, name=title), places)


def bumps(u: Array, v: Array) -> Array:
    """Return two bumps and a dent, 1 mm high, whose slopes are steepest 3 mm from their middle."""
    spots = ((-30.0, 22.0, 1.0), (12.0, -33.0, -1.0), (35.0, 10.0, 1.0))
    heights = [h * np.exp(-((u - x) ** 2 + (v - y) ** 2) / 18.0) for x, y, h in spots]
    return np.sum(heights, axis=0)


def grooves(u: Array, v: Array) -> Array:
    """Return two straight grooves across the plate, 1 mm deep, that cross."""
    along_u, along_v = v + 0.3 * u - 12.0, u - 0.2 * v + 15.0
    return -np.exp(-(along_u**2) / 18.0) - np.exp(-(along_v**2) / 18.0)


def nothing(u: Array, v: Array) -> Array:
    """Return no relief."""
    return np.zeros_like(u)


def ball() -> Part:
    """Return a sphere of radius 30 mm."""

    def places(rng: np.random.Generator, count: int) -> Array:
        return 30.0 * gm.directions.random(count, seed=int(rng.integers(10**9)))

    surface = gm.surfaces.ellipsoid(a=30.0, b=30.0, c=30.0)
    return Part("a sphere of radius 30 mm", surface, places, (64, 64))


BUMPS = plate("the plate with two bumps and a dent", bumps)
PARTS = (
    BUMPS,
    plate("the plate with two grooves", grooves),
    plate("the plate alone", nothing),
    ball(),
)


def samples(part: Part, density: str, count: int) -> Array:
    """Return points that gaussmap chooses on a part."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)  # planar parts are intended
        spline = gm.fit(part.surface, part.cells)
        return gm.sample(spline, count=count, density=density, fields=("points",)).points


# --- registration ---------------------------------------------------------------------------------


@dataclass
class Errors:
    """What is left of the starts: angles in degrees, shifts of the origin and of the points."""

    turns: list[float] = field(default_factory=list)
    shifts: list[float] = field(default_factory=list)
    points: list[float] = field(default_factory=list)

    def add(self, transform: Array, chosen: Array) -> None:
        """Add the result of one run, whose truth is the identity."""
        R, t = transform[:3, :3], transform[:3, 3]
        # By the sine: the cosine of a small angle says little.
        axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
        sine, cosine = np.linalg.norm(axis) / 2.0, (np.trace(R) - 1.0) / 2.0
        self.turns.append(float(np.degrees(np.arctan2(sine, cosine))))
        self.shifts.append(float(np.linalg.norm(t)))
        moved = chosen @ R.T + t - chosen
        self.points.append(float(np.linalg.norm(moved, axis=1).mean()))

    def cells(self) -> list[str]:
        """Return the columns of a table."""
        spread = [f"{np.quantile(x, q):.3f}" for x in (self.turns, self.shifts) for q in (0.5, 0.9)]
        middle = f"{np.median(self.points):.3f}"
        return [*spread, middle, f"{self.failed} of {len(self.points)}"]

    @property
    def failed(self) -> int:
        """How many runs failed."""
        return sum(x > FAILED for x in self.points)


def start(rng: np.random.Generator, slide: float) -> Array:
    """Return a random rigid motion (4, 4)."""
    axis = gm.directions.random(1, seed=int(rng.integers(10**9)))[0]
    across = np.cross(np.eye(3), axis)  # across @ x = axis × x
    angle = np.radians(TURN)
    motion = np.eye(4)
    motion[:3, :3] += np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
    motion[:3, 3] = [*rng.uniform(-slide, slide, 2), rng.uniform(-LIFT, LIFT)]
    return motion


def scan(part: Part, rng: np.random.Generator) -> Any:  # noqa: ANN401
    """Return a noisy cloud of Open3D with normals estimated from neighbours."""
    import open3d  # pyright: ignore[reportMissingImports]

    points = part.places(rng, SCAN)
    points = points + rng.normal(0.0, NOISE, points.shape)
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(NEIGHBOURS))
    return cloud


def registered(chosen: Array, target: Any, first: Array) -> Array:  # noqa: ANN401
    """Return the motion (4, 4) that point-to-plane ICP finds from a first one."""
    import open3d  # pyright: ignore[reportMissingImports]

    icp = open3d.pipelines.registration
    source = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(chosen))
    method = icp.TransformationEstimationPointToPlane()
    ends = icp.ICPConvergenceCriteria(1e-9, 1e-9, 300)
    return icp.registration_icp(source, target, REACH, first, method, ends).transformation


def errors(
    part: Part, plans: Sequence[Sequence[Array]], slide: float, seeds: int = SEEDS
) -> list[Errors]:
    """Register sets of points to the same scans from the same starts.

    Of each plan the first set starts there, and the next ones go on from where that ended.
    """
    found, everywhere = [Errors() for _ in plans], part.places(np.random.default_rng(0), 1000)
    for seed in range(1, seeds + 1):
        rng = np.random.default_rng(seed)
        target, first = scan(part, rng), start(rng, slide)
        for sets, result in zip(plans, found, strict=True):
            motion = first
            for chosen in sets:
                motion = registered(chosen, target, motion)
            result.add(motion, everywhere)
    return found


# --- the page -------------------------------------------------------------------------------------

HEAD = """\
# Registration: which samples fix a part

Written by `make registration`: do not edit.

A part is registered with a scan of it: point-to-plane ICP of Open3D {version} moves N points of the
exact part onto {scan:,} noisy points (σ = {noise} mm in each coordinate, normals estimated by
Open3D from {neighbours} neighbours). The three sets of points differ in nothing but the `density=`
of `gm.sample`. Every row is {seeds} scans, each with another noise and initial position, the same
for all three sets: rotated by {turn:g}° about a random axis, lifted by up to {lift} mm and moved
along each side by up to the given slide. The plates are {size:g} mm wide paraboloids with the
radius of curvature {radius:g} mm; bumps and grooves are 1 mm high and about 10 mm wide. Columns:

- **turn** and **shift**: the errors of the rotation (degrees) and of the translation of the origin
  (mm), median and 90 % quantile;
- **points**: the mean distance of points of the part from their true positions (mm), median;
- **failed**: how often this distance is more than {failed} mm.
"""

MEANING = """\
## Results

Where small features determine the position of a part, samples that are dense on them are better:
with N = {few}, {half} and {many} the error of the points is {ratios} times as large with uniform
samples as with "gauss", and {balanced} times as large as with "balanced" (by the medians).

This has a price. ICP does not find a feature in the scan if the initial error is larger than the
feature: with slides of up to {far:g} mm, {failed} of {seeds} runs fail. Uniform samples first, and
the others from the result (the rows with an arrow), combine the basin of attraction of the former
with the accuracy of the latter.

Grooves determine the position along all their length. They are curved in one direction only, so
that K ≈ 0 and few normals are theirs: the errors of the points are {grooves} mm.

Where no feature determines the position no choice of points does: the plate alone slides and turns,
the sphere turns, and the remaining error is about as large as the initial one, or larger.
"""

COLUMNS = ["turn 50 %", "90 %", "shift 50 %", "90 %", "points", "failed"]
Rows = list[tuple[str, str, Errors]]


def by_count() -> Rows:
    """Measure the plate with bumps for several N."""
    sets = [(count, x, samples(BUMPS, x, count)) for count in COUNTS for x in DENSITIES]
    found = errors(BUMPS, [[points] for *_, points in sets], SLIDES[0])
    return [(f"{count:,}", x, result) for (count, x, _), result in zip(sets, found, strict=True)]


def by_slide() -> Rows:
    """Measure the plate with bumps for several starts."""
    sets = {x: samples(BUMPS, x, COUNT) for x in DENSITIES}
    plans = {x: [sets[y] for y in x.split(THEN)] for x in PLANS}
    return [
        (f"{slide:g} mm", title, result)
        for slide in SLIDES
        for title, result in zip(plans, errors(BUMPS, [*plans.values()], slide), strict=True)
    ]


def by_part() -> Rows:
    """Measure the other parts."""
    rows = []
    for part in PARTS[1:]:
        found = errors(part, [[samples(part, x, COUNT)] for x in DENSITIES], SLIDES[0])
        rows += [(part.title, x, result) for x, result in zip(DENSITIES, found, strict=True)]
    return rows


def table(title: str, first: str, rows: Rows) -> str:
    """Return a section of the page."""
    cells = [[label, density, *result.cells()] for label, density, result in rows]
    return f"## {title}\n\n{markdown([first, 'density', *COLUMNS], cells)}"


def meaning(counts: Rows, slides: Rows, parts: Rows) -> str:
    """Return the results in words."""
    middle = np.reshape([np.median(result.points) for *_, result in counts], (-1, 3))
    few, half, many = (f"{x:,}" for x in COUNTS)
    text = MEANING.format(
        few=few, half=half, many=many, far=SLIDES[-1], seeds=SEEDS,
        ratios=listed(f"{x:.1f}" for x in middle[:, 0] / middle[:, 1]),
        balanced=listed(f"{x:.1f}" for x in middle[:, 0] / middle[:, 2]),
        failed=listed(f"{x.failed} ({plan})" for _, plan, x in slides[-len(PLANS):]),
        grooves=listed(f"{np.median(x.points):.3f} ({plan})" for _, plan, x in parts[:3]),
    )  # fmt: skip
    return wrapped(text)


def head() -> str:
    """Return what is measured, and how."""
    import open3d  # pyright: ignore[reportMissingImports]

    text = HEAD.format(
        version=open3d.__version__, scan=SCAN, noise=NOISE, neighbours=NEIGHBOURS, seeds=SEEDS,
        turn=TURN, lift=LIFT, size=SIZE, radius=RADIUS, failed=FAILED,
    )  # fmt: skip
    return wrapped(text)


def main() -> None:
    """Measure everything and print the page."""
    counts, slides, others = by_count(), by_slide(), by_part()
    title = BUMPS.title.capitalize()
    parts = [
        head(),
        table(f"{title}: how many points (slide: {SLIDES[0]:g} mm)", "N", counts),
        table(f"{title}: how far the start is off (N = {COUNT})", "slide", slides),
        table(f"Other parts (N = {COUNT}, slide: {SLIDES[0]:g} mm)", "part", others),
        meaning(counts, slides, others),
        "\n".join(machine()) + "\n",
    ]
    print("\n".join(parts), end="")


if __name__ == "__main__":
    main()
