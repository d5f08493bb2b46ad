"""The support function as an object: sources, values, operations (paper, Sect. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base import bridge
from ...runtime.base.checks import finite_array, finite_number
from ...runtime.base.errors import InputError, shown
from ...runtime.base.tolerances import ROTATION_ERROR
from ...runtime.directions.unit import as_normals
from ...runtime.fitting.fit import patches_of
from ...runtime.spline.nets import AnySpline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from .branches import Branches
from .operations import Moved, Sum
from .sources import PatchSource, Source, SplineSource

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True, eq=False, repr=False)
class SupportFunction:
    """A support function h(n): the distance of the tangent plane with normal n from the origin.

    Make one with `of_spline`, `of_patch` or `from_sympy`. Several points of a surface may share a
    normal, each on a *branch* of h; `branches` returns all of them. The envelope operator (7) gives
    the points, so that operations on surfaces are simple operations on support functions: `+`
    (convolution), `offset`, `translated`, `rotated`, `scaled`, `reversed`. They return new objects,
    which are evaluated lazily. A call, ``h(normals)``, returns the values of a single-valued h, NaN
    outside the domain.

    Examples
    --------
    >>> import gaussmap as gm
    >>> h = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")  # an ellipsoid
    >>> h([[1, 0, 0], [0, 0, 1]])
    array([2., 1.])
    >>> h.expression, h.domain
    (sqrt(4*n_x**2 + n_y**2 + n_z**2), True)
    >>> (h + h.offset(1.0))([[1, 0, 0]])
    array([5.])

    """

    _source: Source

    def __post_init__(self) -> None:
        if not hasattr(self._source, "sheets"):
            raise InputError(
                "make a SupportFunction by of_spline, of_patch or from_sympy, not of "
                f"{shown(self._source)}."
            )

    @classmethod
    def of_spline(
        cls, surface: AnySpline | Surface | str, cells: Sequence[int] | None = None
    ) -> SupportFunction:
        """Return the support function of a spline, with the branches of all its patches.

        Each point with a given normal, inside the trim, gives exactly one branch. Flat and
        developable patches have no support function, and so no branch.

        Parameters
        ----------
        surface : Spline, Surface or str
            A `Surface`, or the name of one, is approximated by a spline first.
        cells : (int, int), optional
            The cells of that spline, see `fit`.

        Returns
        -------
        SupportFunction
            The support function.

        Raises
        ------
        InputError
            For an object that is not a surface, and for `cells` with a spline.
        UnknownNameError, SurfaceError
            As `fit`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> h = gm.SupportFunction.of_spline("torus", (16, 16))
        >>> h.sheets([[1, 0, 0], [0, 1, 1]])
        array([2, 2])

        """
        surface = named(surface)
        if not isinstance(surface, AnySpline | Surface):
            raise InputError(f"of_spline takes a Spline or Surface, not {type(surface).__name__}.")
        return cls(SplineSource(patches_of(surface, cells)))

    @classmethod
    def of_patch(cls, control_points: ArrayLike) -> SupportFunction:
        """Return the support function of a quadratic Bézier triangle (10).

        It is a cubic over a quadratic form on the Gaussian image of the closed triangle, and
        single-valued there: a normal has one branch or none, decided exactly, also on the boundary.
        Normals of parabolic and singular points have no branch.

        Parameters
        ----------
        control_points : (6, 3) array_like
            The control points in the order b200, b020, b002, b110, b101, b011.

        Returns
        -------
        SupportFunction
            The support function.

        Raises
        ------
        InputError
            For another shape, NaN, infinity, numbers too large to compute with, and for a patch
            that is flat or developable or has no regular point.

        Examples
        --------
        >>> import gaussmap as gm
        >>> points = [(3, 0, 0), (0, 3, 0), (0, 0, 3), (2, 2, 1), (2, 1, 2), (1, 2, 2)]
        >>> h = gm.SupportFunction.of_patch(points)
        >>> h([[1, 1, 1], [-1, 0, 0]]).round(3)
        array([2.502,   nan])

        """
        return cls(PatchSource.checked(control_points))

    @classmethod
    def from_sympy(
        cls,
        h: sympy.Expr | str | float,
        normal: Sequence[sympy.Symbol | str] = ("n_x", "n_y", "n_z"),
        domain: object = None,
    ) -> SupportFunction:
        """Return the support function given by a SymPy expression (or text) on the unit sphere.

        `h` is evaluated at unit normals only, so that it may be any function of the components of
        the normal. If it is homogeneous of degree 1, its gradient is the envelope; otherwise the
        envelope is (5), with the intrinsic gradient (6). Derivatives are taken by SymPy and
        compiled. Normals where h or its gradient is not real and finite have no branch. A kink,
        such as that of |n_x|, is a planar region of the surface, which has no samples.

        Parameters
        ----------
        h : sympy.Expr, str or float
            The expression; texts are read as in `Surface.from_sympy`.
        normal : three of sympy.Symbol or str, default ("n_x", "n_y", "n_z")
            The components of the normal.
        domain : sympy condition or str, optional
            The domain, such as "n_z > 0" or "(n_x > 0) & (n_y > 0)"; by default the whole sphere.

        Returns
        -------
        SupportFunction
            The support function.

        Raises
        ------
        InputError
            For an expression that is not real or has other symbols, uses functions that cannot be
            compiled, or is too large.

        Examples
        --------
        >>> import gaussmap as gm
        >>> h = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)", domain="n_x > 0")
        >>> h([[1, 0, 0], [-1, 0, 0]])
        array([ 2., nan])

        """
        from .expression import ExpressionSource

        return cls(ExpressionSource.checked(h, normal, domain))

    # --- values -----------------------------------------------------------------------------------

    def branches(self, normals: ArrayLike) -> Branches:
        """Return all branches at normals.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.

        Returns
        -------
        Branches
            One row for each branch, by normal, then by patch.

        Raises
        ------
        InputError
            For normals that have another shape, are empty, zero, NaN or infinite.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.of_spline("torus", (16, 16)).branches([[1, 0, 0], [0, 1, 1]])
        Branches(2 elliptic, 2 hyperbolic)

        """
        return self._counted(normals)[0]

    def sheets(self, normals: ArrayLike) -> NDArray[np.int64]:
        """Return the number of branches at each normal.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.

        Returns
        -------
        (S,) int64 array
            The numbers.

        Raises
        ------
        InputError
            As `branches`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.of_spline("sphere", (16, 16)).sheets([[1, 0, 0]])
        array([1])

        """
        return self._counted(normals)[1]

    def contains(self, normals: ArrayLike) -> NDArray[np.bool_]:
        """Return which normals lie in the domain of h.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.

        Returns
        -------
        (S,) bool array
            Whether a normal has a branch.

        Raises
        ------
        InputError
            As `branches`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> h = gm.SupportFunction.from_sympy("1", domain="n_z > 0")
        >>> h.contains([[0, 0, 1], [0, 0, -1]])
        array([ True, False])

        """
        return self.sheets(normals) > 0

    def envelope(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return the points x(n) of the envelope (5) at normals with one branch or none.

        Parameters
        ----------
        normals : (S, 3) array_like
            Directions of any length but 0.

        Returns
        -------
        (S, 3) float64 array
            The points; NaN outside the domain.

        Raises
        ------
        InputError
            If a normal has several branches (`branches` returns all of them), and as `branches`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> h = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")
        >>> h.envelope([[3, 0, 0]])
        array([[2., 0., 0.]])

        """
        return self._single_valued(normals, "points")

    def __call__(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return h(n/|n|), (S,), NaN outside the domain; errors as in `envelope`."""
        return self._single_valued(normals, "support")

    def _counted(self, normals: ArrayLike) -> tuple[Branches, NDArray[np.int64]]:
        """Return all branches, and their number at each normal."""
        directions = as_normals(normals)
        with np.errstate(all="ignore"):  # infinite curvatures and radii are valid
            sheets = self._source.sheets(directions)
        counts = np.bincount(sheets.normal_index, minlength=len(directions))
        return sheets.branches(directions), counts.astype(np.int64)

    def _single_valued(self, normals: ArrayLike, field: str) -> NDArray[np.float64]:
        """Return a field of the branch at each normal; InputError if a normal has several branches.

        The field is NaN at a normal without a branch.
        """
        branches, counts = self._counted(normals)
        if counts.max() > 1:
            worst = int(np.argmax(counts > 1))
            raise InputError(
                f"normals[{worst}] has {counts[worst]} branches; branches(normals) returns them."
            )
        found = getattr(branches, field)
        values = np.full((len(counts), *found.shape[1:]), np.nan)
        values[branches.normal_index] = found
        return values

    # --- operations -------------------------------------------------------------------------------

    def __add__(self, other: SupportFunction) -> SupportFunction:
        """Return the convolution of two surfaces: all sums of two points with the same normal.

        Each normal gets every pair of branches. `patch_index` and `uv` are those of the summand
        that has patches, or −1 and NaN if both summands have patches.
        """
        if not isinstance(other, SupportFunction):
            return NotImplemented
        return SupportFunction(Sum(self._source, other._source))

    def __radd__(self, other: object) -> SupportFunction:
        """Return 0 + h = h, so that `sum` can add several."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def offset(self, distance: float) -> SupportFunction:
        """Return h + d |n|: the offset surface of the points x + d n.

        Parameters
        ----------
        distance : float
            The distance d; for d < 0 the offset lies inwards, if normals point outwards.

        Returns
        -------
        SupportFunction
            The support function of the offset.

        Raises
        ------
        InputError
            Unless the distance is a finite number.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.from_sympy("1").offset(0.5)([[1, 0, 0]])
        array([1.5])

        """
        d = finite_number(distance, "distance")
        return self._moved(f"offset by {d:g}", distance=d)

    def translated(self, shift: ArrayLike) -> SupportFunction:
        """Return h + n·t: the surface of the points x + t.

        Parameters
        ----------
        shift : (3,) array_like
            The vector t.

        Returns
        -------
        SupportFunction
            The support function of the translated surface.

        Raises
        ------
        InputError
            Unless t is three finite numbers.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.from_sympy("1").translated((2, 0, 0))([[1, 0, 0], [0, 1, 0]])
        array([3., 1.])

        """
        t = finite_array(shift, (3,), "shift")
        return self._moved(f"translated by {tuple(t.tolist())}", shift=t)

    def rotated(self, rotation: ArrayLike) -> SupportFunction:
        """Return h(Rᵀn): the surface of the points R x.

        Parameters
        ----------
        rotation : (3, 3) array_like
            The rotation matrix R.

        Returns
        -------
        SupportFunction
            The support function of the rotated surface.

        Raises
        ------
        InputError
            Unless R Rᵀ = 1 (up to 1e-12) and det R = 1.

        Examples
        --------
        >>> import gaussmap as gm
        >>> h = gm.SupportFunction.from_sympy("sqrt(4*n_x**2 + n_y**2 + n_z**2)")
        >>> h.rotated([[0, -1, 0], [1, 0, 0], [0, 0, 1]])([[0, 1, 0]])
        array([2.])

        """
        R = finite_array(rotation, (3, 3), "rotation")
        with np.errstate(over="ignore", invalid="ignore"):
            orthogonal = np.abs(R @ R.T - np.eye(3)).max() <= ROTATION_ERROR
        if not orthogonal:
            raise InputError("rotation must be an orthogonal matrix: R Rᵀ is not the identity.")
        if np.linalg.det(R) < 0.0:
            raise InputError("rotation must have det R = 1; this one is a reflection.")
        return self._moved("rotated", rotation=R)

    def scaled(self, factor: float) -> SupportFunction:
        """Return s h: the surface of the points s x.

        For s < 0 the points are also reflected in the origin, and keep their normals, since p_u ×
        p_v is multiplied by s² > 0. So the radii change sign.

        Parameters
        ----------
        factor : float
            The factor s.

        Returns
        -------
        SupportFunction
            The support function of the scaled surface.

        Raises
        ------
        InputError
            Unless s is finite and not 0.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.from_sympy("1").scaled(-2)([[1, 0, 0]])
        array([-2.])

        """
        s = finite_number(factor, "factor")
        if s == 0.0:
            raise InputError("factor must not be 0: the surface would shrink to a point.")
        return self._moved(f"scaled by {s:g}", factor=s)

    def reversed(self) -> SupportFunction:
        """Return −h(−n): the same surface with the opposite orientation.

        Returns
        -------
        SupportFunction
            The support function of the surface with reversed normals.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.SupportFunction.from_sympy("1").reversed()([[1, 0, 0]])
        array([-1.])

        """
        return self._moved("reversed", side=-1.0)

    def _moved(self, text: str, **how: Any) -> SupportFunction:  # noqa: ANN401
        return SupportFunction(Moved(self._source, text, **how))

    # --- how it is written ------------------------------------------------------------------------

    @property
    def expression(self) -> sympy.Expr | None:
        """The SymPy expression h in n_x, n_y, n_z, valid on the unit sphere; None for splines."""
        return self._source.expression()

    @property
    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """The domain as a SymPy condition on n_x, n_y, n_z; None for splines (see `contains`).

        Where an expression is not finite there is no branch either; the condition does not state
        this.
        """
        return self._source.domain()

    def _repr_latex_(self) -> str | None:
        """Show the expression in a notebook, if there is one."""
        expression = self.expression
        if expression is None:
            return None
        return rf"$\displaystyle h(\mathbf{{n}}) = {bridge.latex_of(expression)}$"

    def __repr__(self) -> str:
        return f"SupportFunction({self._source})"
