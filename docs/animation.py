"""Draw the animation at the top of the README and of the site, light and dark.

Dots leave uniform normals on the unit sphere, and land on the points of a torus that have these
normals: two dots for each normal. At the end, one normal and its points are marked.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import gaussmap as gm
import numpy as np
from gaussmap.docs.dark import dark
from gaussmap.docs.drawing import Floats, Picture
from gaussmap.tools.files.paths import atomic_path
from gaussmap.tools.pictures.marked import marked
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, INK, MARK, PALE
from gaussmap.tools.pictures.scene import Scene, scene_of, view
from gaussmap.tools.pictures.sphere_half import draw_globe
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import KDTree

FILE = Path(__file__).parent / "figures" / "normals.gif"
DARK = FILE.with_name("normals_dark.gif")
NORMALS = 1_000
WIDTH, HEIGHT, DPI = 8.2, 3.6, 100  # inches, and pixels per inch
SPHERE, TORUS, MIDDLE = -2.7, 1.95, -0.2  # the centres, in inches from that of the picture
RADIUS, SCALE = 1.2, 1.35  # inches for one unit of length
# Milliseconds: of a frame while points move, and of the pictures before, after, and at the end.
MOVE, HOLD = 80, (1800, 2000, 4000)
# The frames in motion, and the share of them after which the last point leaves.
FRAMES, LATEST = 56, 0.45
COLOURS = 44  # the number of frequent colours, besides those that must be exact
TEXTS = (
    f"{NORMALS:,} normals $n$, uniform on the sphere",
    r"the gradient of the support function takes them to points: $x = \nabla h(n)$",
    f"{2 * NORMALS:,} points: all that have these normals, dense where $|K|$ is large",
    "one normal and its two points, with $K > 0$ (blue) and $K < 0$ (orange)",
)


class Actors(NamedTuple):
    """The moving dots: positions (N, 2) of normals and points, colours, and when each leaves."""

    normals: Floats
    points: Floats
    front: Any
    visible: Any
    colours: Floats
    start: Floats
    order: Any


def draw(light: Path, in_dark: Path) -> None:
    """Write the animation to two .gif files, for light and for dark pages."""
    scene = scene_of(gm.surfaces.torus(1.0, 0.4), view(34.0, -60.0))
    samples = gm.sample(gm.surfaces.torus(1.0, 0.4), 2 * NORMALS, density="gauss")
    visible = scene.visible(samples.points)
    actors, stage = actors_of(samples, scene, visible), stage_of(scene)
    pictures = [
        frame(stage, actors, moment, TEXTS[0 if moment == 0.0 else 2 if moment == 1.0 else 1])
        for moment in np.linspace(0.0, 1.0, FRAMES)
    ]
    mark = marked(samples, visible, scene.view)
    assert mark is not None
    arrow = RADIUS * (scene.view @ mark.normal)[:2]
    ends = np.vstack([arrow + np.array([SPHERE, MIDDLE]), actors.points[mark.samples]])
    pictures.append(frame(stage, actors, 1.0, TEXTS[3], ends, arrow))
    palette = palette_of([pictures[k] for k in (0, FRAMES // 2, -1)], COLOURS)
    frames = [reduced(picture, palette) for picture in pictures]
    for path, colours in ((light, palette), (in_dark, dark(palette))):
        first, *others = (with_palette(x, colours) for x in frames)
        with atomic_path(path) as temporary:
            first.save(
                temporary, format="GIF", save_all=True, append_images=others, loop=0,
                optimize=False, duration=[HOLD[0], *[MOVE] * (FRAMES - 2), *HOLD[1:]],
            )  # fmt: skip


def actors_of(samples: gm.Samples, scene: Scene, visible: Any) -> Actors:  # noqa: ANN401
    """Return the dots for samples; the dots on the right of the sphere leave first."""
    seen = samples.normals @ scene.view.T
    land = scene.seen(samples.points)
    start = (1.0 - seen[:, 0]) / 2 * LATEST
    return Actors(
        RADIUS * seen[:, :2] + [SPHERE, MIDDLE],
        SCALE * land[:, :2] + [TORUS, MIDDLE],
        seen[:, 2] >= 0.0,
        visible,
        np.where(samples.elliptic[:, None], to_rgb(ELLIPTIC), to_rgb(HYPERBOLIC)),
        start,
        np.argsort(land[:, 2]),
    )


def panel() -> tuple[Figure, Any]:
    """Return a figure and axes that fill it, one unit per inch, with the origin in the middle."""
    figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    limits(axes)
    return figure, axes


def limits(axes: Any) -> None:  # noqa: ANN401
    """Show the same part of the plane in all pictures."""
    axes.set(xlim=(-WIDTH / 2, WIDTH / 2), ylim=(-HEIGHT / 2, HEIGHT / 2))
    axes.set_aspect("equal", adjustable="box")


def stage_of(scene: Scene) -> Floats:
    """Return the pixels of the background, the torus and the globe."""
    from matplotlib.transforms import Affine2D

    figure, axes = panel()
    Picture(axes, scene).surface("#e3e6ea")
    (mesh,) = axes.collections
    mesh.set_transform(Affine2D().scale(SCALE).translate(TORUS, MIDDLE) + axes.transData)
    before = set(axes.get_children())
    draw_globe(axes, scene.view)
    shift = Affine2D().scale(RADIUS).translate(SPHERE, MIDDLE) + axes.transData
    for artist in set(axes.get_children()) - before:
        artist.set_transform(shift)
    limits(axes)
    return pixels_of(figure)


def pixels_of(figure: Figure) -> Floats:
    """Return the pixels (height, width, 3) of a figure."""
    content = BytesIO()
    figure.savefig(content, format="png", dpi=DPI)
    return np.asarray(Image.open(content).convert("RGB"))


def frame(
    stage: Floats,
    actors: Actors,
    moment: float,
    text: str,
    ends: Floats | None = None,
    arrow: Floats | None = None,
) -> Image.Image:
    """Return the picture at a moment between 0 and 1, with a text, and arrows at marked places."""
    figure, axes = panel()
    sides = (-WIDTH / 2, WIDTH / 2, -HEIGHT / 2, HEIGHT / 2)
    axes.imshow(stage, extent=sides, interpolation="none", zorder=0)
    limits(axes)
    axes.text(
        0.0, HEIGHT / 2 - 0.22, text, ha="center", va="center", fontsize=12.5, color=INK, zorder=9
    )
    # Small dots mark the normals after they have left.
    axes.scatter(*actors.normals[actors.front].T, s=2.0, color=PALE, linewidths=0.0, zorder=4)
    places, colours = moved(actors, moment)
    shown = actors.order[colours[actors.order, 3] > 0.02]
    axes.scatter(*places[shown].T, s=11.0, c=colours[shown], linewidths=0.0, zorder=5)
    if ends is not None and arrow is not None:
        for end in ends:
            axes.annotate(
                "", end + 0.4 * arrow, end, zorder=8,
                arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.3, "shrinkA": 0.0},
            )  # fmt: skip
        axes.scatter(*ends.T, s=62, color=MARK, edgecolors=INK, linewidths=1.1, zorder=9)
    return Image.fromarray(pixels_of(figure))


def moved(actors: Actors, moment: float) -> tuple[Floats, Floats]:
    """Return positions (N, 2) and colours (N, 4) at a moment; hidden dots are transparent."""
    way = np.clip((moment - actors.start) / (1.0 - LATEST), 0.0, 1.0)[:, None]
    way = way * way * (3.0 - 2.0 * way)
    places = (1.0 - way) * actors.normals + way * actors.points
    colours = (1.0 - way) * to_rgb(INK) + way * actors.colours
    before, after = np.where(actors.front, 1.0, 0.12), np.where(actors.visible, 1.0, 0.0)
    return places, np.hstack([colours, (1.0 - way) * before[:, None] + way * after[:, None]])


def palette_of(pictures: list[Image.Image], colours: int) -> NDArray[np.uint8]:
    """Return a palette (k, 3) for all pictures: `colours` frequent colours, and some exact ones."""
    together = np.concatenate([np.asarray(picture) for picture in pictures])
    chosen = Image.fromarray(together).quantize(colours, method=Image.Quantize.MEDIANCUT)
    exact = [to_rgb(name) for name in ("white", MARK, INK, ELLIPTIC, HYPERBOLIC)]
    rest = np.array(chosen.getpalette(), dtype=np.uint8)[: 3 * colours].reshape(-1, 3)
    return np.concatenate([np.round(255 * np.array(exact)).astype(np.uint8), rest])


def reduced(picture: Image.Image, palette: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the indices of the nearest colours of a palette; Pillow's own are less near."""
    pixels = np.asarray(picture)
    found, which = np.unique(pixels.reshape(-1, 3), axis=0, return_inverse=True)
    nearest = np.asarray(KDTree(palette).query(found)[1]).astype(np.uint8)
    return nearest[which].reshape(pixels.shape[:2])


def with_palette(numbers: NDArray[np.uint8], palette: NDArray[np.uint8]) -> Image.Image:
    """Return the picture with the given colours of a palette, by their indices."""
    image = Image.fromarray(numbers, mode="P")
    image.putpalette(palette.ravel().tolist())
    return image
