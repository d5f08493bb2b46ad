"""A page with a surface and the unit sphere of its normals; selected points and normals light up.

Plotly.js draws the page: the Python package of Plotly contains a complete library for three
dimensions in browsers as one script, which is embedded in the page, so that it needs no network.
(k3d needs Jupyter's widgets, and pythreejs is bundled for notebooks only.)
"""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Sequence
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array
from ...runtime.base.errors import InputError, printable
from ...runtime.base.extras import check_extra, from_extra
from ...runtime.base.trees import tree_of
from ...runtime.samples.samples import Samples
from ...runtime.spline.nets import AnySpline
from ...runtime.surface.surface import Surface
from ..cad.part import Face, Part
from ..files import paths
from ..files.lengths import whole_of
from ..pictures.palette import ELLIPTIC, HYPERBOLIC, PARABOLIC, SCALE
from ..pictures.scene import Scene, scene_of_samples

SUFFIXES = (".html", ".htm")
SCRIPTS = (
    "theme", "samples", "scene", "camera", "front", "picking", "selection", "highlights", "link",
)  # fmt: skip
COUNT = 5_000  # the default number of samples
MOST = 50_000  # the most samples in a page that stays fluid
NEIGHBOURS = 8  # neighbours of each sample, for finding connected groups
LEAST_ANGLE, MOST_ANGLE = 1.0, 20.0  # in degrees: the limits of the initial angle around a normal
PARABOLIC_LEGEND = (
    '<span class="legend"><span class="dot" style="background:{}"></span>'
    "parabolic (K = 0)</span>"  # flat, too
)
# The hints that the page shows for clicks: on a surface, and on a part.
HINTS = (
    "Click a place: its region and their normals light up.",
    "Click a face: its samples and their normals light up.",
)
# The colours of elliptic, hyperbolic and parabolic samples; selected samples have darker colours.
PALE = (SCALE[4], SCALE[2], "#b9b9b9")
# Colours of faces without a colour in the file; neighbouring faces seldom have the same colour.
COLOURS_OF_FACES = ("#c9d6df", "#e3d5bd", "#cfe0cf", "#dfcfdc", "#c8dcdc", "#e0d0c8", "#d3d3e3")
# The margin around the surface, relative to its diameter: samples are drawn above the surface (LIFT
# in scene.js), and points outside of the range of an axis are not drawn.
MARGIN = 0.02
RADIUS = 10.0  # of the initial region around a point, in per cent of the diameter


def view(
    self: Samples, path: str | os.PathLike[str], surface: Surface | AnySpline | Part | None = None
) -> None:
    """Write one page for browsers: the surface and the unit sphere, which light up together.

    Click a normal on the sphere, and its preimages light up on the surface; click a point of the
    surface, and the Gaussian image of the region around it lights up on the sphere. On a CAD part,
    a click on a face selects all of its samples; faces have the colours of the file. With the
    brush, or the shift key, drag to paint. The page is self-contained, of 5 MB and more, and works
    without a network.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file, with the suffix `.html` or `.htm`. It is written as a whole or not at all.
    surface : Surface, Spline or Part, optional
        The surface of the samples, if they do not hold it.

    Raises
    ------
    MissingExtraError
        Without Plotly: ``pip install "gaussmap[view]"``.
    UnknownNameError
        If the suffix is another one.
    FileError
        If the file cannot be written.
    MissingFieldError
        If the samples lack points, normals, Gaussian curvature or normal indices.
    InputError
        Without samples, for more than 50,000, and if the surface is unknown.
    SurfaceError
        If the surface cannot be drawn.

    Notes
    -----
    A click next to the dot of a sample selects the normal of that sample; another click selects the
    direction at the pointer, or, if all samples are at prescribed normals, the nearest of these.
    The points that light up are

    - the samples with exactly this normal, up to the rounding of float32, if it is a prescribed
      one, or if several samples have it, as on planes. Made with ``normals=icosphere(…)``,
      samples are all points with that normal.
    - else one sample for each connected group of samples, of one sign of K, whose normals are
      within an angle of the selected direction: the sample nearest in normal. That counts
      preimages correctly where samples are dense relative to the angle, which a slider
      changes, but not next to parabolic lines, where two preimages are about to meet.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("torus", 200, cells=(16, 16)).view("torus.html")

    """
    check_target(path)
    content = page(self, surface)
    with paths.atomic_path(path) as temporary:
        temporary.write_text(content, encoding="utf-8")


def check_count(count: int) -> None:
    """Raise InputError if a page cannot show this number of samples."""
    if count > MOST:
        raise InputError(
            f"a page shows at most {MOST:,} samples, not {count:,}; take fewer, "
            "or the first ones in a progressive order."
        )


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise now the errors that `view` would raise later: for its path, or without Plotly."""
    paths.check_target(path, SUFFIXES)
    check_extra("plotly", "view", "a page with a picture to turn")


def page(samples: Samples, surface: Surface | AnySpline | Part | None = None) -> str:
    """Return the page as text."""
    if not len(samples):
        raise InputError("there are no samples to view.")
    check_count(len(samples))
    scene = scene_of_samples(samples, surface)
    data = _data(samples, scene, surface)
    here = files(__name__.rpartition(".")[0])
    offline = from_extra("plotly.offline", "view", "a page with a picture to turn")
    return Template((here / "page.html").read_text(encoding="utf-8")).substitute(
        title=html.escape(printable(" ".join(samples.report.surface.split())[:200])),
        summary=html.escape(printable(samples.summary())),
        style=(here / "style.css").read_text(encoding="utf-8"),
        script="\n".join((here / f"{x}.js").read_text(encoding="utf-8") for x in SCRIPTS),
        plotly=offline.get_plotlyjs().replace("</script", "<\\/script"),
        # "<" in the data could end the script element.
        data=json.dumps(data, allow_nan=False).replace("<", "\\u003c"),
        surface=("Part" if data["part"] else "Surface") + _heights(scene),
        hint=HINTS[data["part"] is not None],
        elliptic=PALE[0],
        hyperbolic=PALE[1],
        parabolic_legend=PARABOLIC_LEGEND.format(PALE[2]) if samples.parabolic.any() else "",
    )


def _heights(scene: Scene) -> str:
    """Return a note that heights are exaggerated or reduced; empty if they are not."""
    if scene.factor == 1.0:
        return ""
    how = "exaggerated" if scene.factor > 1.0 else "reduced"
    return f" (heights {how} {max(scene.factor, 1 / scene.factor):g} times)"


def _data(
    samples: Samples, scene: Scene, surface: Surface | AnySpline | Part | None
) -> dict[str, Any]:
    """Return the data for the script, with the centre of the surface as origin and diameter 1."""
    corners = scene.quadrangles.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, diameter = low / 2 + high / 2, float(np.linalg.norm(high - low)) or 1.0
    vertices, numbers = np.unique(
        ((corners - middle) / diameter).astype(np.float32), axis=0, return_inverse=True
    )
    a, b, c, d = numbers.reshape(-1, 4).T
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    one, two, three = triangles.T
    proper = (one != two) & (two != three) & (three != one)
    triangles = triangles[proper]
    factors = np.array([1.0, 1.0, scene.factor])
    half = (high - low) / diameter / 2
    reach = np.maximum(1.04 * half, half + MARGIN)
    aspect = reach * factors
    points = (samples.points.astype(np.float64) - middle) / diameter
    normals = samples.normals.astype(np.float64)
    found: dict[str, Any] = {
        "points": _encoded(points, np.float32),
        "normals": _encoded(normals, np.float32),
        "kind": _encoded(np.where(samples.parabolic, 2, samples.hyperbolic), np.uint8),
        "prescribed": _encoded(samples.normal_index >= 0, np.uint8),
        "neighbours": _encoded(_neighbours(points), np.int32),
        "vertices": _encoded(vertices, np.float32),
        "triangles": _encoded(triangles, np.int32),
        "flat": bool((scene.quadrangles[:, 2] == scene.quadrangles[:, 3]).all()),
        "aspect": (2.7 * aspect / np.linalg.norm(aspect)).tolist(),
        "aspect_factors": factors.tolist(),
        "range": np.stack([-reach, reach], axis=1).tolist(),
        "centre": middle.tolist(),
        "diameter": diameter,
        "angle": _spacing(normals),
        "radius": RADIUS,
        "colours": [ELLIPTIC, HYPERBOLIC, PARABOLIC],
        "pale": PALE,
        "part": None,
    }
    part = whole_of(samples) if surface is None else surface
    if isinstance(part, Part) and scene.faces is not None and samples.face_index is not None:
        place = np.tile(scene.faces, 2)[proper], samples.face_index
        found["part"] = _data_of_part(part, *place, _gaps(scene.lines, middle, diameter))
    return found


def _data_of_part(
    part: Part, of_triangles: NDArray[np.int64], of_samples: NDArray[np.int64], edges: Array
) -> dict[str, Any]:
    """Return the face indices of triangles and samples, colour and text of each face, and edges."""
    return {
        "of_triangles": _encoded(of_triangles, np.int32),
        "of_samples": _encoded(of_samples, np.int32),
        "colours": [_colour(x) for x in part.faces],
        "labels": [_said(x, part.unit) for x in part.faces],
        "edges": _encoded(edges, np.float32),
    }


def _colour(face: Face) -> str:
    """Return the colour of a face in the file, or else one of COLOURS_OF_FACES by its index."""
    if face.color is None:
        return COLOURS_OF_FACES[face.index % len(COLOURS_OF_FACES)]
    return "#" + bytes(round(255 * x) for x in face.color).hex()


def _said(face: Face, unit: str) -> str:
    """Return the text that the page shows for a selected face."""
    name = f" {face.name!r}" if face.name else ""
    sizes = {x: y for x, y in face.dimensions.items() if x.endswith("radius")}
    said = [f"{x.replace('_', ' ')} {y:.6g} {unit}".rstrip() for x, y in sizes.items()]
    return ", ".join([f"Face {face.source_index}{name}: {face.kind}", *said])


def _gaps(lines: Sequence[Array], middle: Array, diameter: float) -> Array:
    """Return lines in the page's coordinates as one array (k, 3), with NaN between them."""
    apart = np.full((1, 3), np.nan)
    rows = [y for x in lines for y in ((x - middle) / diameter, apart)]
    return np.concatenate(rows) if rows else apart


def _encoded(array: NDArray[Any], dtype: type[np.generic]) -> str:
    little = np.ascontiguousarray(array, dtype=np.dtype(dtype).newbyteorder("<"))
    return base64.b64encode(little.tobytes()).decode("ascii")


def _neighbours(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the indices (N, k) of the nearest neighbours of each sample."""
    count = min(NEIGHBOURS, len(points) - 1)
    if count == 0:
        return np.zeros((1, 1), np.int64)
    nearest = np.asarray(tree_of(points).query(points, k=count + 1)[1])
    return nearest[:, 1:]


def _spacing(normals: NDArray[np.float64]) -> float:
    """Return the angle in degrees within which nearly every normal has a neighbour."""
    distinct = np.unique(normals.round(6), axis=0)
    if len(distinct) < 2:
        return LEAST_ANGLE
    distances = tree_of(distinct).query(distinct, k=2)[0][:, 1]
    angle = np.degrees(2.0 * np.arcsin(min(float(np.percentile(distances, 95.0)) / 2.0, 1.0)))
    return float(np.clip(angle, LEAST_ANGLE, MOST_ANGLE).round(1))
