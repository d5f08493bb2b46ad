"""The figure of docs/alignment.md: two meshes of the same worst angle, side by side."""

from __future__ import annotations

import math
from itertools import pairwise

import gaussmap as gm
import matplotlib.style
import numpy as np
from gaussmap.benchmarks.peers.mesh_metrics import Quality, quality
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.quality.surfaces import SmallFillets
from gaussmap.docs.drawing import Picture, panels
from gaussmap.docs.figures import FOLDER, filled
from gaussmap.tools.files.paths import atomic_path
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, STYLE
from gaussmap.tools.pictures.scene import Scene, quadrangles, view

__all__ = ["NAME", "draw", "pair"]

NAME = "alignment.png"
COUNT = 3_000  # balanced samples
PLACES = 50_000
TRIES, NEAR = 6, 0.03

Made = tuple[gm.Mesh, Quality]


def made(form: SmallFillets, places: Places, density: str, count: int) -> Made:
    """Return a mesh and how good it is."""
    samples = gm.sample(form.surface, count=count, density=density)
    mesh = samples.mesh(prefer="normals")
    return mesh, quality(form, places, (mesh.vertices, mesh.triangles))


def pair(form: SmallFillets, count: int = COUNT) -> tuple[Made, Made]:
    """Return two meshes of the same worst angle, balanced and aligned."""
    places = Places.of(form, PLACES)
    balanced = made(form, places, "balanced", count)
    wanted, tried = float(count), []
    for _ in range(TRIES):
        tried.append(made(form, places, "aligned", round(wanted)))
        worst = tried[-1][1].worst / balanced[1].worst
        wanted = tried[-1][1].vertices * worst**2
        if abs(worst - 1.0) < NEAR:
            break
    return balanced, min(tried, key=lambda x: abs(math.log(x[1].worst / balanced[1].worst)))


def draw() -> str:
    """Draw the figure, and return the lines of Markdown that show it."""
    form = SmallFillets()
    found = pair(form)
    with matplotlib.style.context(["default", STYLE]):
        figure, axes = panels(
            7.4, 3.1, 1, 2, left=0.005, right=0.995, bottom=0.0, top=0.92, wspace=0.01
        )
        scene = Scene(
            quadrangles(gm.fit(form.surface).evaluate(*lattice(form))), view=view(38.0, -55.0)
        )
        titles = ("balanced", "aligned")
        for k, (mesh, quality) in enumerate(found):
            title = f"{titles[k]}: {quality.vertices:,} vertices, worst angle {quality.worst:.1f}°"
            picture = Picture(axes[0, k], scene, title, shape=0.75)
            picture.surface()
            seen = scene.visible(mesh.vertices)[mesh.edges].all(axis=1)
            lines = list(mesh.vertices[mesh.edges[seen]])
            colour = (ELLIPTIC, HYPERBOLIC)[k]
            picture.lines(lines, hide=False, colors=colour, linewidths=0.3, zorder=3)
        with atomic_path(FOLDER / NAME) as temporary:
            figure.savefig(temporary, format="png", metadata={"Software": None})
    return f"![Two meshes]({FOLDER.name}/{NAME})\n\n{filled(caption(*(x for _, x in found)))}\n"


def lattice(form: SmallFillets) -> tuple[np.ndarray, np.ndarray]:
    """Return parameters of a mesh that the picture shades, denser where the boss is rounded."""
    (u0, u1), _ = form.surface.domain
    u = np.linspace(u0, u1, 121)
    ends = [0.0, *form.joints]
    parts = [np.linspace(a, b, 13)[:-1] for a, b in pairwise(ends)]
    return u[:, None], np.concatenate([*parts, ends[-1:]])[None]


def caption(balanced: Quality, aligned: Quality) -> str:
    """Return the caption."""
    return (
        f"The boss with small fillets of [the quality page](quality.md), meshed with the same "
        f'worst angle between normals of surface and mesh. Left: `density="balanced"`, '
        f"{balanced.vertices:,} vertices, worst angle {balanced.worst:.2f}°, Hausdorff distance "
        f'{balanced.hausdorff:.1e}. Right: `density="aligned"`, {aligned.vertices:,} vertices, '
        f"{aligned.worst:.2f}°, {aligned.hausdorff:.1e}."
    )
