"""Gaussian images: of one patch, and of all patches of a spline (paper, Sect. 3.2)."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import gaussian_image as formulas
from ...runtime.base.checks import real_array
from ...runtime.base.errors import InputError, shown
from ...runtime.directions.unit import as_normals
from ...runtime.fitting.fit import patches_of
from ...runtime.spline.nets import AnySpline
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from .area import measures_of
from .boundary import BoundaryArc, boundary_arcs, edge_arcs
from .classes import PatchClass, classes_of
from .membership import PatchNormals
from .parabolic_lines import Piece, pieces_of
from .patches import Patches, checked_control_points

Array = NDArray[np.float64]
NAMES = {
    PatchClass.SINGULAR: "empty",
    PatchClass.PLANAR: "point",
    PatchClass.DEVELOPABLE: "arc",
    PatchClass.MIXED: "bow tie",
}
BY_SIDES = {2: "biangle", 3: "triangle"}


@dataclass(frozen=True, eq=False)
class GaussianImage:
    """The Gaussian image of one quadratic patch: the set of its unit normals on the sphere.

    Make one with `of_patch`, or take one from a `GaussianImages`. Whether a quantity vanishes
    (`kind`, `patch_class`, `is_great_circle` of an arc) is decided up to the rounding of the
    coordinates.

    Attributes
    ----------
    control_points : (6, 3) float64 array
        The control points in the order b200, b020, b002, b110, b101, b011.

    Examples
    --------
    >>> import gaussmap as gm
    >>> net = gm.fit("torus", (16, 16)).control_nets[0]
    >>> image = gm.gauss_map.GaussianImage.of_patch(net)
    >>> image, image.kind, image.patch_class.name
    (GaussianImage(triangle), 'triangle', 'ELLIPTIC')
    >>> image.area == image.solid_angle, f"{image.area:.3f}"  # elliptic; in steradians
    (True, '0.039')
    >>> len(image.arcs), len(image.boundary), len(image.pieces), image.cones.shape
    (3, 3, 1, (3, 3, 3))
    >>> image.control_points.shape
    (6, 3)

    """

    control_points: Array

    def __post_init__(self) -> None:
        points = checked_control_points(self.control_points)
        object.__setattr__(self, "control_points", points)

    def __repr__(self) -> str:
        return f"GaussianImage({self.kind})"

    @classmethod
    def of_patch(cls, control_points: ArrayLike) -> GaussianImage:
        """Return the Gaussian image of a patch.

        Parameters
        ----------
        control_points : (6, 3) array_like
            The control points in the order b200, b020, b002, b110, b101, b011.

        Returns
        -------
        GaussianImage
            The image.

        Raises
        ------
        InputError
            For another shape, NaN, infinity, or numbers too large to compute with.

        Examples
        --------
        >>> import gaussmap as gm
        >>> points = [(0, 0, 0), (2, 0, 1), (0, 2, 1), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        >>> gm.gauss_map.GaussianImage.of_patch(points)
        GaussianImage(triangle)

        """
        return cls(control_points)  # pyright: ignore[reportArgumentType]

    @cached_property
    def kind(self) -> str:
        """The shape of the image.

        "triangle": three arcs bound it. "biangle": two arcs, since one edge is a parabolic line,
        whose image is a point. "polygon": more arcs, since a corner or a point inside an edge is
        singular, see `boundary`. "bow tie": a parabolic line runs through the patch, and its image
        is a point. "arc": the patch is developable. "point": it is planar (two opposite points if
        it is folded). "empty": no point of the patch has a normal.
        """
        if self.patch_class in NAMES:
            return NAMES[self.patch_class]
        if len(self.pieces) > 1:
            return "bow tie"
        return BY_SIDES.get(len(self.boundary), "polygon")

    @cached_property
    def patch_class(self) -> PatchClass:
        """The class of the patch, see `classify_patches`."""
        return PatchClass(int(classes_of(self._patch)[0]))

    @cached_property
    def cones(self) -> Array:
        """The three symmetric matrices M (3, 3, 3) of the cones nᵀ M n = 0 through the `arcs`.

        They are the matrices of the quadratic forms U, V, W, up to a common positive factor; the
        edges are u = 0, v = 0 and w = 1 − u − v = 0. The three forms have the same sign at the
        normals of the patch and at their opposites, and only there.
        """
        rows = self._patch.apply(formulas.boundary_cones)
        return np.array([[x[0] for x in row] for row in rows]).reshape(3, 3, 3)

    @cached_property
    def arcs(self) -> tuple[BoundaryArc, BoundaryArc, BoundaryArc]:
        """The normals along the edges u = 0, v = 0 and w = 0, counter-clockwise in (u, v).

        They run from v = 1 to w = 1, from w = 1 to u = 1 and from u = 1 to v = 1. An edge that is
        collapsed to a point gets the limit of the normals nearby.
        """
        return edge_arcs(self._patch.normals[0], self._noise)

    @cached_property
    def boundary(self) -> tuple[BoundaryArc, ...]:
        """The sides of the image, in order: each begins where the one before ends.

        They are the `arcs` that are not a single point, split at singular points of an edge. At a
        singular point of the boundary the limits of the normals form an arc of a great circle,
        which is a side, too: half a great circle if the normals of an edge change to their
        opposites. The chain is closed; it has gaps between opposite normals only if the image has
        no interior, or if a curve of singular points ends there. Parts of the boundary of the image
        that come from singular points inside the patch are not included.
        """
        return boundary_arcs(self._patch.normals[0], self._noise)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces of the patch, on each of which K has one sign, see `split_patch`."""
        return pieces_of(self._patch)

    @cached_property
    def solid_angle(self) -> float:
        """The integral of the Gaussian curvature over the patch, in steradians."""
        return float(self._measures[0][0])

    @cached_property
    def area(self) -> float:
        """The area of the image in steradians: the integral of |K| over the patch."""
        return float(self._measures[1][0])

    def contains(self, normals: ArrayLike) -> NDArray[np.bool_]:
        """Return a mask of the directions that are oriented normals of the patch.

        The boundary belongs to the image. The result is exact for the given control points and
        directions: signs that rounding leaves open are decided with integers. So an image without
        interior ("arc", "point") contains only the few directions that lie on it exactly. A
        singular point has no normal.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.

        Returns
        -------
        (S,) bool array
            Whether a direction is a normal.

        Raises
        ------
        InputError
            For another shape, NaN, infinity or a zero vector.

        Examples
        --------
        >>> import gaussmap as gm
        >>> points = [(0, 0, 0), (2, 0, 1), (0, 2, 1), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        >>> image = gm.gauss_map.GaussianImage.of_patch(points)
        >>> image.contains([[0, 0, 1], [-1, -1, 4], [0, 0, -1]])
        array([ True,  True, False])

        """
        as_normals(normals)
        return PatchNormals(self.control_points).contain(real_array(normals, "normals"))

    @cached_property
    def _patch(self) -> Patches:
        return Patches.of_control_points(self.control_points[None])

    @cached_property
    def _measures(self) -> tuple[Array, Array]:
        return measures_of(self._patch, np.array([self.patch_class], dtype=np.int8))

    @property
    def _noise(self) -> float:
        return float(self._patch.normal_noise[0])


@dataclass(frozen=True, eq=False)
class GaussianImages:
    """The Gaussian images of all patches of a spline, the domain of its support function.

    Made by `of_spline`. ``images[k]`` is the image of patch k; patches are numbered as in `Spline`.

    Attributes
    ----------
    spline : Spline
        The spline.

    Examples
    --------
    >>> import gaussmap as gm
    >>> images = gm.gauss_map.GaussianImages.of_spline("torus", (16, 16))
    >>> len(images), images[0], images.spline
    (1024, GaussianImage(triangle), Spline(16 × 16 cells of torus))
    >>> f"{images.areas.sum():.2f}", bool(abs(images.solid_angles.sum()) < 1e-12)  # 8π and 2π χ
    ('25.13', True)
    >>> images.patch_classes.shape
    (1024,)

    """

    spline: AnySpline

    def __post_init__(self) -> None:
        if not isinstance(self.spline, AnySpline):
            raise InputError(
                f"GaussianImages takes a Spline, not {type(self.spline).__name__}; for a surface "
                "there is GaussianImages.of_spline, and for one patch GaussianImage.of_patch."
            )
        if isinstance(self.spline, Spline) and self.spline.trim is not None:
            raise InputError(
                f"{self.spline.name!r} is trimmed; Gaussian images are of whole patches: choose "
                "a domain that ends at its border."
            )

    def __repr__(self) -> str:
        return f"GaussianImages({len(self):,} patches)"

    @classmethod
    def of_spline(
        cls, spline: AnySpline | Surface | str, cells: Sequence[int] | None = None
    ) -> GaussianImages:
        """Return the Gaussian images of a spline.

        Parameters
        ----------
        spline : Spline, Surface or str
            A `Surface`, or the name of one, is approximated by a spline first.
        cells : (int, int), optional
            The cells of that spline, see `fit`.

        Returns
        -------
        GaussianImages
            The images.

        Raises
        ------
        InputError
            For `cells` with a spline, for trimmed surfaces, and as `fit`.
        UnknownNameError, SurfaceError
            As `fit`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.gauss_map.GaussianImages.of_spline("torus", (16, 16))
        GaussianImages(1,024 patches)

        """
        return cls(patches_of(spline, cells))

    def __len__(self) -> int:
        """Return the number of patches."""
        return self.spline.patches

    def __getitem__(self, patch: int) -> GaussianImage:
        """Return the image of one patch; IndexError if absent, InputError for other types."""
        try:
            number = operator.index(patch)
        except TypeError:
            raise InputError(f"a patch is picked by its number, not by {shown(patch)}.") from None
        return GaussianImage(self.spline.control_nets[number])

    @cached_property
    def patch_classes(self) -> NDArray[np.int8]:
        """(patches,) int8 array: the `PatchClass` of each patch."""
        return classes_of(self._patches)

    @cached_property
    def solid_angles(self) -> Array:
        """(patches,) float64 array: the integral of the Gaussian curvature over each patch.

        On a closed surface they sum to 2π χ: to 4π if it has the topology of a sphere, to 0 on a
        torus.
        """
        return self._measures[0]

    @cached_property
    def areas(self) -> Array:
        """(patches,) float64 array: the areas of the images in steradians, integrals of |K|."""
        return self._measures[1]

    @cached_property
    def _measures(self) -> tuple[Array, Array]:
        return measures_of(self._patches, self.patch_classes)

    @cached_property
    def _patches(self) -> Patches:
        return Patches.of_spline(self.spline)
