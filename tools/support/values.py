"""The values of a support function at normals: branches, points of the envelope, domain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.errors import InputError, shown
from ...runtime.directions.unit import as_normals
from .branches import Branches
from .sources import Source

__all__ = ["SupportValues"]


@dataclass(frozen=True, eq=False, repr=False)
class SupportValues:
    """What `SupportFunction` evaluates: the values of its source at normals."""

    _source: Source

    def __post_init__(self) -> None:
        if not hasattr(self._source, "sheets"):
            raise InputError(
                "make a SupportFunction by of_spline, of_patch or from_sympy, not of "
                f"{shown(self._source)}."
            )

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
        """Return a field of the branches, NaN without one; InputError for several of a normal."""
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
